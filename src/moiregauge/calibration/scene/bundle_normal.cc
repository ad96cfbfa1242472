// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/scene/bundle_normal.h"

#include <array>
#include <cmath>

#include <Eigen/Cholesky>

#include "moiregauge/calibration/scene/small_products.h"

namespace moiregauge::internal {
namespace {

constexpr int kSceneColumns = kCommonParameters + kShapeParameters;  // columns of a patch that belong to the scene
constexpr int kPlace = PatchColumn::kShape + MarkerShape::kX;        // a shift has the same two columns

using Matrix2 = Eigen::Matrix2d;
constexpr int kAtOnce = PatchColumn::kColumns;  // columns without those of the motion
// Matrix that eliminates a shift. The shift's step is -matrix * (step of the patch's other columns, 1).
template <int kMotion>
using ShiftRows = Eigen::Matrix<double, 2, kAtOnce + kMotion>;

template <int kSize>
Eigen::Matrix<double, 2, kSize> shift_rows(const Eigen::Matrix<double, kSize, kSize>& n, double damping) {
  Matrix2 own = n.template block<2, 2>(kPlace, kPlace);
  own.diagonal() *= 1.0 + damping;
  own.diagonal().array() += kLeastShiftInformation;
  return own.llt().solve(n.template middleRows<2>(kPlace));
}

// Returns the index among all scene parameters of column k of this marker's patch.
int column(std::size_t marker, int k) {
  return k < kCommonParameters ? k : kShapeParameters * static_cast<int>(marker) + k;
}

// Focal length, distance, tilts, heights and lens terms can change together and leave the image nearly the same. Such a
// change keeps value / f^power constant. The step is linear in that quantity, so it follows the curved valley. To first
// order it equals the plain step.
double scaled_step(double value, double step, double log_f, int power) {
  return (value + step - power * log_f * value) * std::exp(power * log_f);
}

// Returns the power of f with which a scene parameter changes.
int power_of_f(int index) {
  constexpr std::array<int, kCommonParameters> kOfCamera{1, 0, 0, 2, 4, 1, 1, 6};
  if (index < kCommonParameters) return kOfCamera[static_cast<std::size_t>(index)];
  return (index - kCommonParameters) % kShapeParameters >= MarkerShape::kHeight ? 1 : 0;
}

}  // namespace

double robust(double chi2) {
  return chi2 <= kRobustFrom * kRobustFrom ? chi2 : kRobustFrom * (2.0 * std::sqrt(chi2) - kRobustFrom);
}

double robust_weight(double chi2) { return chi2 <= kRobustFrom * kRobustFrom ? 1.0 : kRobustFrom / std::sqrt(chi2); }

double& parameter(BundleState& state, int index) {
  if (index < kCommonParameters) return state.common[static_cast<std::size_t>(index)];
  const auto k = static_cast<std::size_t>(index - kCommonParameters);
  return state.markers[k / kShapeParameters].value[k % kShapeParameters];
}

double BundlePatch::chi2(const BundleState& at, const TurnedPose& pose) const {
  const auto shift = shifts ? at.shifts[frame][marker] : Extent<frame::Board>{};
  PatchResidual::Vector off = residual.residual(at.common, at.markers[marker], pose, shift);
  if (rows) off += rows->by_motion * at.motions[frame];
  return off.squaredNorm();
}

// Quantities of one frame that the back substitution needs.
template <int kMotion>
struct BundleNormal::Frame {
  Eigen::Matrix<double, 6 + kMotion, Eigen::Dynamic> rows;  // step of pose and motion = -rows * (step of the scene, 1)
  std::vector<ShiftRows<kMotion>> shifts;                   // one per patch that shifts
  bool ok = true;
};

struct BundleNormal::Eliminated {
  std::optional<Frame<0>> still;  // global shutter
  std::optional<Frame<kMotionParameters>> rolling;
  [[nodiscard]] bool ok() const { return still ? still->ok : rolling->ok; }
};

BundleNormal::BundleNormal(std::span<const BundlePatch> patches, std::span<const SceneParameter> free,
                           const BundleState& at)
    : patches_(patches),
      free_(free),
      places_(static_cast<std::size_t>(shape_row(at.markers.size(), 0)), -1),
      at_(at),
      normal_(patches.size()) {
  for (std::size_t a = 0; a < free.size(); ++a) places_[static_cast<std::size_t>(free[a].index)] = static_cast<int>(a);
  std::optional<TurnedPose> pose;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    const BundlePatch& patch = patches[p];
    if (p == 0 || patch.frame != patches[p - 1].frame) pose.emplace(at.poses[patch.frame]);
    auto design = patch.residual.design(at.common, at.markers[patch.marker], *pose,
                                        patch.shifts ? at.shifts[patch.frame][patch.marker] : Extent<frame::Board>{});
    if (patch.rows) design.col(PatchColumn::kResidual) += patch.rows->by_motion * at.motions[patch.frame];
    normal_[p] = normal_matrix(design);
    const double counts = robust_weight(normal_[p](PatchColumn::kResidual, PatchColumn::kResidual));
    normal_[p] *= counts;
    if (!patch.rows) continue;
    of_motion_.resize(patches.size());
    of_motion_[p].leftCols<kAtOnce>() = counts * product_of_columns(patch.rows->by_motion, design);
    of_motion_[p].rightCols<kMotionParameters>() = counts * normal_matrix(patch.rows->by_motion);
  }
}

template <int kMotion>
BundleNormal::PatchNormal<kMotion> BundleNormal::normal_of(std::size_t patch) const {
  if constexpr (kMotion == 0) {
    return normal_[patch];
  } else {
    PatchNormal<kMotion> n;
    n.template topLeftCorner<kAtOnce, kAtOnce>() = normal_[patch];
    n.template bottomRows<kMotion>() = of_motion_[patch];
    n.template topRightCorner<kAtOnce, kMotion>() = of_motion_[patch].template leftCols<kAtOnce>().transpose();
    return n;
  }
}

std::size_t BundleNormal::end_of_frame(std::size_t first) const {
  std::size_t end = first;
  while (end < patches_.size() && patches_[end].frame == patches_[first].frame) ++end;
  return end;
}

// Returns the place of a patch's column k among the free parameters. Fixed parameters (-1) take no part.
int BundleNormal::place_of(std::size_t marker, int k) const {
  return places_[static_cast<std::size_t>(column(marker, k))];
}

// Eliminates one frame's pose, shifts and motion. Adds the remainder to the lower triangle of `scene`. Its rows are the
// free parameters, and the last is the right-hand side.
template <int kMotion>
BundleNormal::Frame<kMotion> BundleNormal::eliminated(std::size_t first, std::size_t end, double damping,
                                                      Eigen::MatrixXd& scene) const {
  constexpr int kOwn = 6 + kMotion;
  const Eigen::Index size = this->size();
  Frame<kMotion> out;
  Eigen::Matrix<double, kOwn, kOwn> own = Eigen::Matrix<double, kOwn, kOwn>::Zero();
  Eigen::Matrix<double, kOwn, 1> diagonal = Eigen::Matrix<double, kOwn, 1>::Zero();
  Eigen::Matrix<double, kOwn, Eigen::Dynamic> across = Eigen::Matrix<double, kOwn, Eigen::Dynamic>::Zero(kOwn, size);
  for (std::size_t p = first; p < end; ++p) {
    PatchNormal<kMotion> n = normal_of<kMotion>(p);
    diagonal.template head<6>() += n.diagonal().template segment<6>(PatchColumn::kPose);
    if constexpr (kMotion > 0) diagonal.template tail<kMotion>() += n.diagonal().template tail<kMotion>();
    if (patches_[p].shifts) {
      out.shifts.push_back(shift_rows<kAtOnce + kMotion>(n, damping));
      const Eigen::Matrix<double, kAtOnce + kMotion, 2> by_shift = n.template middleCols<2>(kPlace);
      n.noalias() -= by_shift.lazyProduct(out.shifts.back());
    }
    const auto place = [&](int k) { return k == kSceneColumns ? size - 1 : place_of(patches_[p].marker, k); };
    const auto from = [](int k) { return k == kSceneColumns ? PatchColumn::kResidual : k; };
    own.template topLeftCorner<6, 6>() += n.template block<6, 6>(PatchColumn::kPose, PatchColumn::kPose);
    if constexpr (kMotion > 0) {
      own.template bottomRows<kMotion>().template leftCols<6>() +=
          n.template bottomRows<kMotion>().template middleCols<6>(PatchColumn::kPose);
      own.template rightCols<kMotion>().template topRows<6>() +=
          n.template rightCols<kMotion>().template middleRows<6>(PatchColumn::kPose);
      own.template bottomRightCorner<kMotion, kMotion>() += n.template bottomRightCorner<kMotion, kMotion>();
    }
    for (int a = 0; a <= kSceneColumns; ++a) {
      if (place(a) < 0) continue;
      across.col(place(a)).template head<6>() += n.template block<6, 1>(PatchColumn::kPose, from(a));
      if constexpr (kMotion > 0)
        across.col(place(a)).template tail<kMotion>() += n.template bottomRows<kMotion>().col(from(a));
      for (int b = 0; b <= kSceneColumns; ++b) {
        if (place(b) >= place(a)) scene(place(b), place(a)) += n(from(b), from(a));
      }
    }
  }
  if constexpr (kMotion > 0) {
    const auto& information = patches_[first].rows->information;
    own.template bottomRightCorner<kMotion, kMotion>() += information;
    across.col(size - 1).template tail<kMotion>() += information * at_.motions[patches_[first].frame];
  }
  own.diagonal() += damping * diagonal;
  const Eigen::LLT<Eigen::Matrix<double, kOwn, kOwn>> llt(own);
  out.ok = llt.info() == Eigen::Success;
  out.rows = llt.solve(across);
  scene.selfadjointView<Eigen::Lower>().rankUpdate(llt.matrixL().solve(across).transpose(), -1.0);
  return out;
}

// Applies the step to the frame's pose, shifts and motion. Returns half the gradient along the whole step, with the
// scene's part.
template <int kMotion>
double BundleNormal::substituted(std::size_t first, std::size_t end, const Frame<kMotion>& frame,
                                 const Eigen::VectorXd& moved, BundleState& to) const {
  const Eigen::Matrix<double, 6 + kMotion, 1> step = -frame.rows * moved;
  const double log_f = places_[0] < 0 ? 0.0 : moved(places_[0]) / at_.common[0];
  const std::size_t number = patches_[first].frame;
  Pose& pose = to.poses[number];
  for (std::size_t k = 0; k < 3; ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    pose.turn[k] = scaled_step(pose.turn[k], step(row), log_f, k < 2 ? 1 : 0);
    pose.shift[k] = scaled_step(pose.shift[k], step(row + 3), log_f, k < 2 ? 0 : 1);
  }
  double along = 0.0;
  if constexpr (kMotion > 0) {
    to.motions[number] += step.template tail<kMotion>();
    along += step.template tail<kMotion>().dot(patches_[first].rows->information * at_.motions[number]);
  }
  std::size_t shift = 0;
  for (std::size_t p = first; p < end; ++p) {
    Eigen::Matrix<double, kAtOnce + kMotion, 1> d;
    for (int k = 0; k < kSceneColumns; ++k) {
      const int place = place_of(patches_[p].marker, k);
      d(k) = place < 0 ? 0.0 : moved(place);
    }
    d.template segment<6>(PatchColumn::kPose) = step.template head<6>();
    d(PatchColumn::kResidual) = 1.0;
    if constexpr (kMotion > 0) d.template tail<kMotion>() = step.template tail<kMotion>();
    if (patches_[p].shifts) {
      const Eigen::Vector2d by = -frame.shifts[shift++] * d;
      auto& place = to.shifts[number][patches_[p].marker];
      place.x += by.x(), place.y += by.y();
      d.template segment<2>(kPlace) += by;
    }
    d(PatchColumn::kResidual) = 0.0;
    along += normal_[p].col(PatchColumn::kResidual).dot(d.template head<kAtOnce>());
    if constexpr (kMotion > 0) along += of_motion_[p].col(PatchColumn::kResidual).dot(d.template tail<kMotion>());
  }
  return along;
}

BundleNormal::Eliminated BundleNormal::frame_eliminated(std::size_t first, double damping,
                                                        Eigen::MatrixXd& scene) const {
  const std::size_t end = end_of_frame(first);
  if (patches_[first].rows) return {std::nullopt, eliminated<kMotionParameters>(first, end, damping, scene)};
  return {eliminated<0>(first, end, damping, scene), std::nullopt};
}

double BundleNormal::frame_substituted(std::size_t first, const Eliminated& frame, const Eigen::VectorXd& moved,
                                       BundleState& to) const {
  const std::size_t end = end_of_frame(first);
  return frame.still ? substituted<0>(first, end, *frame.still, moved, to)
                     : substituted<kMotionParameters>(first, end, *frame.rolling, moved, to);
}

Eigen::Index BundleNormal::size() const { return static_cast<Eigen::Index>(free_.size()) + 1; }

std::optional<BundleNormal::Step> BundleNormal::step(double damping) const {
  const Eigen::Index size = this->size();
  Eigen::MatrixXd scene = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(size);
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    for (int k = 0; k < kSceneColumns; ++k) {
      const int place = place_of(patches_[p].marker, k);
      if (place >= 0) diagonal(place) += normal_[p](k, k);
    }
  }
  std::vector<Eliminated> frames;
  for (std::size_t first = 0; first < patches_.size(); first = end_of_frame(first)) {
    frames.push_back(frame_eliminated(first, damping, scene));
    if (!frames.back().ok()) return std::nullopt;
  }
  Step out{at_, 0.0};
  const auto n = static_cast<Eigen::Index>(free_.size());
  Eigen::MatrixXd small = scene.topLeftCorner(n, n);  // its lower triangle
  Eigen::VectorXd right(n), prior(n);
  for (Eigen::Index a = 0; a < n; ++a) {
    const SceneParameter& free = free_[static_cast<std::size_t>(a)];
    const double information = 1.0 / (free.u * free.u);
    small(a, a) += information + damping * (diagonal(a) + information);
    prior(a) = (parameter(out.to, free.index) - free.mean) * information;
    right(a) = scene(n, a) + prior(a);
  }
  const Eigen::LLT<Eigen::MatrixXd> llt(small);
  if (llt.info() != Eigen::Success) return std::nullopt;
  const Eigen::VectorXd step = -llt.solve(right);
  Eigen::VectorXd moved(size);
  moved << step, 1.0;
  const double log_f = places_[0] < 0 ? 0.0 : moved(places_[0]) / at_.common[0];
  for (Eigen::Index a = 0; a < n; ++a) {
    const int index = free_[static_cast<std::size_t>(a)].index;
    double& value = parameter(out.to, index);
    value = scaled_step(value, step(a), log_f, power_of_f(index));
  }
  double along = prior.dot(step);
  std::size_t k = 0;
  for (std::size_t first = 0; first < patches_.size(); first = end_of_frame(first))
    along += frame_substituted(first, frames[k++], moved, out.to);
  // The gradient of chi2 is 2 * along. A full step gains half of its product with the gradient.
  out.gain = -along;
  return out;
}

}  // namespace moiregauge::internal
