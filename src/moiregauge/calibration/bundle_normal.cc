// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/bundle_normal.h"

#include <array>
#include <cmath>

#include <Eigen/Cholesky>

namespace moiregauge {
namespace {

constexpr int kShape = MarkerShape::kParameters;
constexpr int kSceneColumns = kCameraParameters + kShape;      // of a patch's columns: those of the scene
constexpr int kPlace = PatchColumn::kShape + MarkerShape::kX;  // a shift has these two columns

using Matrix2 = Eigen::Matrix2d;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
// What eliminates a shift: its step is - row * (step of the patch's other columns, 1).
using ShiftRows = Eigen::Matrix<double, 2, PatchColumn::kColumns>;

// An axis that the print does not show must not run away; 1e4 mm, as in fit_frame.
constexpr double kLeastInformation = 1e-8;

// What an outlying patch counts: the loss' slope at its chi2.
double weight(double chi2) { return chi2 <= kRobustFrom * kRobustFrom ? 1.0 : kRobustFrom / std::sqrt(chi2); }

ShiftRows shift_rows(const Eigen::Matrix<double, PatchColumn::kColumns, PatchColumn::kColumns>& n, double damping) {
  Matrix2 own = n.block<2, 2>(kPlace, kPlace);
  own.diagonal() *= 1.0 + damping;
  own.diagonal().array() += kLeastInformation;
  return own.llt().solve(n.middleRows<2>(kPlace));
}

// Where a patch's column of the scene lies among all parameters.
int column(std::size_t marker, int k) { return k < kCameraParameters ? k : kShape * static_cast<int>(marker) + k; }

// With another focal length the same picture comes from a camera that is as much farther away, tilts and heights as
// much larger, and a lens that bends the same pixels as much as before. Steps are straight in what stays the same,
// value / f^power, and so follow the valley that these make together; to first order they are what they were.
double scaled_step(double value, double step, double log_f, int power) {
  return (value + step - power * log_f * value) * std::exp(power * log_f);
}

// Of a parameter of the scene.
int power_of_f(int index) {
  constexpr std::array<int, kCameraParameters> kOfCamera{1, 0, 0, 2, 4, 1, 1, 6};
  if (index < kCameraParameters) return kOfCamera[static_cast<std::size_t>(index)];
  return (index - kCameraParameters) % kShape == MarkerShape::kHeight ? 1 : 0;
}

}  // namespace

double robust(double chi2) {
  return chi2 <= kRobustFrom * kRobustFrom ? chi2 : kRobustFrom * (2.0 * std::sqrt(chi2) - kRobustFrom);
}

double& parameter(BundleState& state, int index) {
  if (index < kCameraParameters) return state.camera[static_cast<std::size_t>(index)];
  const auto k = static_cast<std::size_t>(index - kCameraParameters);
  return state.markers[k / kShape].value[k % kShape];
}

// What a frame leaves for the way back.
struct BundleNormal::Frame {
  Eigen::Matrix<double, 6, Eigen::Dynamic> rows;  // the pose's step is - rows * (step of the scene, 1)
  std::vector<ShiftRows> shifts;                  // one per patch that shifts
  bool ok = true;
};

BundleNormal::BundleNormal(std::span<const BundlePatch> patches, std::span<const SceneParameter> free,
                           const BundleState& at)
    : patches_(patches), free_(free), at_(at), normal_(patches.size()) {
  std::optional<TurnedPose> pose;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    const BundlePatch& patch = patches[p];
    if (p == 0 || patch.frame != patches[p - 1].frame) pose.emplace(at.poses[patch.frame]);
    const auto design =
        patch.residual.design(at.camera, at.markers[patch.marker], *pose,
                              patch.shifts ? at.shifts[patch.frame][patch.marker] : Extent<frame::Board>{});
    normal_[p].noalias() = design.transpose() * design;
    normal_[p] *= weight(normal_[p](PatchColumn::kResidual, PatchColumn::kResidual));
  }
}

std::size_t BundleNormal::end_of_frame(std::size_t first) const {
  std::size_t end = first;
  while (end < patches_.size() && patches_[end].frame == patches_[first].frame) ++end;
  return end;
}

// Adds what is left of a frame to `scene`, whose last row and column are the right side.
BundleNormal::Frame BundleNormal::eliminated(std::size_t first, std::size_t end, double damping,
                                             Eigen::MatrixXd& scene) const {
  const Eigen::Index size = scene.cols();
  Frame out;
  Matrix6 own = Matrix6::Zero();
  Eigen::Matrix<double, 6, 1> diagonal = Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::Matrix<double, 6, Eigen::Dynamic> across = Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6, size);
  for (std::size_t p = first; p < end; ++p) {
    PatchNormal n = normal_[p];
    diagonal += n.diagonal().segment<6>(PatchColumn::kPose);
    if (patches_[p].shifts) {
      out.shifts.push_back(shift_rows(n, damping));
      const Eigen::Matrix<double, PatchColumn::kColumns, 2> by_shift = n.middleCols<2>(kPlace);
      n.noalias() -= by_shift.lazyProduct(out.shifts.back());
    }
    const auto place = [&](int k) { return k == kSceneColumns ? size - 1 : column(patches_[p].marker, k); };
    const auto from = [](int k) { return k == kSceneColumns ? PatchColumn::kResidual : k; };
    own += n.block<6, 6>(PatchColumn::kPose, PatchColumn::kPose);
    for (int a = 0; a <= kSceneColumns; ++a) {
      across.col(place(a)) += n.block<6, 1>(PatchColumn::kPose, from(a));
      for (int b = 0; b <= kSceneColumns; ++b) scene(place(b), place(a)) += n(from(b), from(a));
    }
  }
  own.diagonal() += damping * diagonal;
  const Eigen::LLT<Matrix6> llt(own);
  out.ok = llt.info() == Eigen::Success;
  out.rows = llt.solve(across);
  scene.noalias() -= across.transpose() * out.rows;
  return out;
}

// Moves the frame's pose and shifts; returns the gradient along the whole step, halved, the scene's part included.
double BundleNormal::substituted(std::size_t first, std::size_t end, const Frame& frame, const Eigen::VectorXd& moved,
                                 BundleState& to) const {
  const Eigen::Matrix<double, 6, 1> step = -frame.rows * moved;
  const double log_f = moved(0) / at_.camera[0];
  Pose& pose = to.poses[patches_[first].frame];
  for (std::size_t k = 0; k < 3; ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    pose.turn[k] = scaled_step(pose.turn[k], step(row), log_f, k < 2 ? 1 : 0);
    pose.shift[k] = scaled_step(pose.shift[k], step(row + 3), log_f, k < 2 ? 0 : 1);
  }
  double along = 0.0;
  std::size_t shift = 0;
  for (std::size_t p = first; p < end; ++p) {
    Eigen::Matrix<double, PatchColumn::kColumns, 1> d;
    for (int k = 0; k < kSceneColumns; ++k) d(k) = moved(column(patches_[p].marker, k));
    d.segment<6>(PatchColumn::kPose) = step;
    d(PatchColumn::kResidual) = 1.0;
    if (patches_[p].shifts) {
      const Eigen::Vector2d by = -frame.shifts[shift++] * d;
      auto& place = to.shifts[patches_[p].frame][patches_[p].marker];
      place.x += by.x(), place.y += by.y();
      d.segment<2>(kPlace) += by;
    }
    d(PatchColumn::kResidual) = 0.0;
    along += normal_[p].col(PatchColumn::kResidual).dot(d);
  }
  return along;
}

Eigen::Index BundleNormal::size() const {
  return kCameraParameters + kShape * static_cast<Eigen::Index>(at_.markers.size()) + 1;
}

std::optional<BundleState> BundleNormal::step_of_frames() const {
  BundleState to = at_;
  const Eigen::VectorXd held = Eigen::VectorXd::Unit(size(), size() - 1);
  Eigen::MatrixXd unused = Eigen::MatrixXd::Zero(size(), size());
  for (std::size_t first = 0; first < patches_.size(); first = end_of_frame(first)) {
    const Frame frame = eliminated(first, end_of_frame(first), 0.0, unused);
    if (!frame.ok) return std::nullopt;
    (void)substituted(first, end_of_frame(first), frame, held, to);
  }
  return to;
}

std::optional<BundleNormal::Step> BundleNormal::step(double damping) const {
  const Eigen::Index size = this->size();
  Eigen::MatrixXd scene = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(size);
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    for (int k = 0; k < kSceneColumns; ++k) diagonal(column(patches_[p].marker, k)) += normal_[p](k, k);
  }
  std::vector<Frame> frames;
  for (std::size_t first = 0; first < patches_.size(); first = end_of_frame(first)) {
    frames.push_back(eliminated(first, end_of_frame(first), damping, scene));
    if (!frames.back().ok) return std::nullopt;
  }
  Step out{at_, 0.0};
  const auto n = static_cast<Eigen::Index>(free_.size());
  Eigen::MatrixXd small(n, n);
  Eigen::VectorXd right(n), prior(n);
  for (Eigen::Index a = 0; a < n; ++a) {
    const SceneParameter& free = free_[static_cast<std::size_t>(a)];
    const double information = 1.0 / (free.u * free.u);
    for (Eigen::Index b = 0; b < n; ++b) small(a, b) = scene(free.index, free_[static_cast<std::size_t>(b)].index);
    small(a, a) += information + damping * (diagonal(free.index) + information);
    prior(a) = (parameter(out.to, free.index) - free.mean) * information;
    right(a) = scene(free.index, size - 1) + prior(a);
  }
  const Eigen::LLT<Eigen::MatrixXd> llt(small);
  if (llt.info() != Eigen::Success) return std::nullopt;
  const Eigen::VectorXd step = -llt.solve(right);
  Eigen::VectorXd moved = Eigen::VectorXd::Zero(size);
  moved(size - 1) = 1.0;
  for (Eigen::Index a = 0; a < n; ++a) {
    const int index = free_[static_cast<std::size_t>(a)].index;
    moved(index) = step(a);
  }
  const double log_f = moved(0) / at_.camera[0];
  for (const SceneParameter& free : free_) {
    double& value = parameter(out.to, free.index);
    value = scaled_step(value, moved(free.index), log_f, power_of_f(free.index));
  }
  double along = prior.dot(step);
  std::size_t k = 0;
  for (std::size_t first = 0; first < patches_.size(); first = end_of_frame(first))
    along += substituted(first, end_of_frame(first), frames[k++], moved, out.to);
  out.gain = -along;  // chi2's gradient is twice this, and half of what it promises is lost again on the way
  return out;
}

}  // namespace moiregauge
