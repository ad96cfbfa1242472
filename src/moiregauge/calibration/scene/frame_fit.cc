// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/scene/frame_fit.h"

#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "moiregauge/calibration/scene/free_parameters.h"
#include "moiregauge/calibration/scene/normal_inverse.h"
#include "moiregauge/calibration/scene/patch_residual.h"

namespace moiregauge::internal {
namespace {

constexpr int kRows = PatchResidual::kSize;
constexpr int kPasses = 4;  // Gauss-Newton steps, chosen
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

template <int kColumns>
using Jacobian = Eigen::Matrix<double, kRows, kColumns>;

// Normal equations of pose and shifts (index f) and scene parameters (index g). Index b is the readout time.
struct Normal {
  Eigen::MatrixXd ff, fg, gg;
  Eigen::VectorXd rf;
  Eigen::VectorXd fb;
  double bb = 0.0, rb = 0.0;
};

Normal empty_normal(int rows, int globals) {
  return {Eigen::MatrixXd::Zero(rows, rows), Eigen::MatrixXd::Zero(rows, globals),
          Eigen::MatrixXd::Zero(globals, globals), Eigen::VectorXd::Zero(rows), Eigen::VectorXd::Zero(rows)};
}

// Adds the grating of marker i. Its shift has two rows from `shift_row`, or none if that is negative. The scene's part
// is added only `with_scene`.
void add_patch(Normal& n, const PatchResidual::Design& design, std::size_t i, int shift_row, bool with_scene) {
  Jacobian<8> own;
  own << design.middleCols<6>(PatchColumn::kPose), design.middleCols<2>(PatchColumn::kShape);
  const auto row = [&](int k) { return k < 6 ? k : shift_row + k - 6; };
  const int used = shift_row < 0 ? 6 : 8;
  const Eigen::Matrix<double, 8, 8> ff = own.transpose() * own;
  const Eigen::Matrix<double, 8, 1> rf = own.transpose() * design.col(PatchColumn::kResidual);
  for (int a = 0; a < used; ++a) {
    n.rf(row(a)) += rf(a);
    for (int b = 0; b < used; ++b) n.ff(row(a), row(b)) += ff(a, b);
  }
  if (!with_scene) return;
  const auto column = [&](int k) { return k < kCommonParameters ? k : k + kShapeParameters * static_cast<int>(i); };
  const Jacobian<kCommonParameters + kShapeParameters> scene = design.leftCols<kCommonParameters + kShapeParameters>();
  const Eigen::Matrix<double, 8, kCommonParameters + kShapeParameters> fg = own.transpose() * scene;
  const Eigen::Matrix<double, kCommonParameters + kShapeParameters, kCommonParameters + kShapeParameters> gg =
      scene.transpose() * scene;
  for (int b = 0; b < kCommonParameters + kShapeParameters; ++b) {
    for (int a = 0; a < used; ++a) n.fg(row(a), column(b)) += fg(a, b);
    for (int a = 0; a < kCommonParameters + kShapeParameters; ++a) n.gg(column(a), column(b)) += gg(a, b);
  }
}

// Adds the rolling shutter's part: the motion from row `first`, and the readout time. `rows` are whitened.
void add_rows(Normal& n, const RowDesign::Columns& rows, const PatchResidual::Design& design, std::size_t i,
              int shift_row, int first, bool with_scene) {
  Jacobian<8> own;
  own << design.middleCols<6>(PatchColumn::kPose), design.middleCols<2>(PatchColumn::kShape);
  const Jacobian<kMotionParameters> by_motion = rows.leftCols<kMotionParameters>();
  const Eigen::Matrix<double, kRows, 1> by_readout = rows.col(kMotionParameters);
  const auto residual = design.col(PatchColumn::kResidual);
  const Eigen::Matrix<double, 8, kMotionParameters> across = own.transpose() * by_motion;
  const Eigen::Matrix<double, 8, 1> readout = own.transpose() * by_readout;
  for (int a = 0; a < (shift_row < 0 ? 6 : 8); ++a) {
    const int row = a < 6 ? a : shift_row + a - 6;
    n.ff.block<1, kMotionParameters>(row, first) += across.row(a);
    n.ff.block<kMotionParameters, 1>(first, row) += across.row(a).transpose();
    n.fb(row) += readout(a);
  }
  n.ff.block<kMotionParameters, kMotionParameters>(first, first).noalias() += by_motion.transpose() * by_motion;
  n.rf.segment<kMotionParameters>(first).noalias() += by_motion.transpose() * residual;
  n.fb.segment<kMotionParameters>(first).noalias() += by_motion.transpose() * by_readout;
  n.bb += by_readout.squaredNorm();
  n.rb += by_readout.dot(residual);
  if (!with_scene) return;
  const auto column = [&](int k) { return k < kCommonParameters ? k : k + kShapeParameters * static_cast<int>(i); };
  const Eigen::Matrix<double, kMotionParameters, kCommonParameters + kShapeParameters> fg =
      by_motion.transpose() * design.leftCols<kCommonParameters + kShapeParameters>();
  for (int b = 0; b < kCommonParameters + kShapeParameters; ++b)
    n.fg.block<kMotionParameters, 1>(first, column(b)) += fg.col(b);
}

// Takes a Gauss-Newton step. Returns false if the gratings do not determine it.
bool take_step(FrameFit& fit, const Normal& n, int first_motion) {
  const Eigen::VectorXd scale = n.ff.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::LDLT<Eigen::MatrixXd> ldlt(scale.asDiagonal() * n.ff * scale.asDiagonal());
  if (ldlt.info() != Eigen::Success || !ldlt.isPositive()) return false;
  const Eigen::VectorXd step = scale.cwiseProduct(ldlt.solve(scale.cwiseProduct(n.rf)));
  for (int k = 0; k < 3; ++k) {
    fit.pose.turn[static_cast<std::size_t>(k)] -= step(k);
    fit.pose.shift[static_cast<std::size_t>(k)] -= step(3 + k);
  }
  for (std::size_t i = 0; i < fit.shift.size(); ++i) {
    if (fit.shift_row[i] < 0) continue;
    fit.shift[i].x -= step(fit.shift_row[i]);
    fit.shift[i].y -= step(fit.shift_row[i] + 1);
  }
  if (first_motion < step.size()) fit.motion -= step.tail<kMotionParameters>();
  return true;
}

// Fills the rolling shutter's fields of the result.
void conclude_rows(FrameFit& fit, const Normal& n, const RowDesign& rows, int first) {
  fit.of_motion = Eigen::VectorXd::Zero(n.ff.rows());
  fit.of_motion.head(first) =
      (fit.covariance.diagonal().head(first) - inverse_of(n.ff.topLeftCorner(first, first)).diagonal()).cwiseMax(0.0);
  fit.by_readout = -fit.covariance * n.fb;
  fit.readout_information = n.bb + n.fb.dot(fit.by_readout);
  fit.readout_slope = n.rb + n.rf.dot(fit.by_readout);
  // Motion costs only the degrees of freedom that the gratings determine beyond its prior.
  const auto known =
      (rows.information * fit.covariance.bottomRightCorner<kMotionParameters, kMotionParameters>()).trace();
  fit.dof -= std::lround(kMotionParameters - known);
}

// A frame's residuals and the layout of its unknowns: pose, shifts of the targets, motion while rows are read.
struct Unknowns {
  std::vector<std::optional<PatchResidual>> patches;  // one per site marker
  int references = 0;
  int first_motion = 6;
  int rows = 6;
};

Unknowns start(FrameFit& fit, const Site& site, const BundleFrame& frame) {
  const std::size_t markers = site.markers.size();
  fit.pose = frame.pose;
  fit.shift.assign(markers, {kNaN, kNaN});
  fit.shift_row.assign(markers, -1);
  fit.chi2.assign(markers, kNaN);
  fit.own_information.assign(markers, Eigen::Matrix2d::Zero());
  Unknowns out;
  out.patches.resize(markers);
  for (std::size_t i = 0; i < markers; ++i) {
    if (!frame.points[i] || !site.markers[i].grating) continue;
    out.patches[i].emplace(*frame.points[i], *site.markers[i].grating);
    out.references += site.markers[i].role == Role::kReference;
    fit.shift[i] = {0, 0};
    if (site.markers[i].role == Role::kReference || frame.at_rest) continue;
    fit.shift[i] = frame.shift[i];
    fit.shift_row[i] = out.rows;
    out.rows += 2;
  }
  out.first_motion = out.rows;
  if (frame.rows) {
    fit.motion = frame.motion;
    out.rows += kMotionParameters;
  }
  return out;
}

// Returns the normal equations at the present unknowns, with those of the scene in the last pass. Sets chi2 and dof.
Normal equations_of(FrameFit& fit, const Unknowns& unknowns, const Scene& scene, const CommonNumbers& camera,
                    const BundleFrame& frame, bool last) {
  const std::size_t markers = unknowns.patches.size();
  const TurnedPose pose(fit.pose);
  Normal n = empty_normal(unknowns.rows, last ? scene_parameters(markers) : 0);
  fit.chi2_sum = 0.0;
  fit.dof = -unknowns.first_motion;
  for (std::size_t i = 0; i < markers; ++i) {
    const auto& patch = unknowns.patches[i];
    if (!patch) continue;
    auto design = patch->design(camera, scene.markers[i], pose, fit.shift[i]);
    if (frame.rows) {
      const RowDesign::Columns by_rows = patch->root() * frame.rows->by_marker[i];
      design.col(PatchColumn::kResidual) += by_rows.leftCols<kMotionParameters>() * fit.motion;
      add_rows(n, by_rows, design, i, fit.shift_row[i], unknowns.first_motion, last);
    }
    add_patch(n, design, i, fit.shift_row[i], last);
    fit.chi2[i] = design.col(PatchColumn::kResidual).squaredNorm();
    fit.chi2_sum += fit.chi2[i];
    fit.dof += kRows;
    const auto by_shift = design.middleCols<2>(PatchColumn::kShape);
    fit.own_information[i] = by_shift.transpose() * by_shift;
  }
  for (int k = 6; k < unknowns.first_motion; ++k) n.ff(k, k) += 1.0 / (kUnknownShift * kUnknownShift);
  if (frame.rows) {
    n.ff.bottomRightCorner<kMotionParameters, kMotionParameters>() += frame.rows->information;
    n.rf.tail<kMotionParameters>() += frame.rows->information * fit.motion;
  }
  return n;
}

}  // namespace

int scene_parameters(std::size_t markers) { return shape_row(markers, 0); }

FrameFit fit_frame(const Site& site, const Scene& scene, const BundleFrame& frame) {
  FrameFit fit;
  const Unknowns unknowns = start(fit, site, frame);
  if (unknowns.references < 3) return fit;
  const CommonNumbers camera = numbers_of(scene);
  Normal n;
  for (int pass = 0; pass <= kPasses; ++pass) {
    const bool last = pass == kPasses;
    n = equations_of(fit, unknowns, scene, camera, frame, last);
    if (!last && !take_step(fit, n, unknowns.first_motion)) return fit;
  }
  fit.covariance = inverse_of(n.ff);
  if (frame.rows) conclude_rows(fit, n, *frame.rows, unknowns.first_motion);
  fit.sensitivity = -fit.covariance * n.fg;
  fit.scene_information = n.gg + n.fg.transpose() * fit.sensitivity;
  fit.ok = std::isfinite(fit.chi2_sum);
  return fit;
}

Eigen::MatrixXd scene_covariance(const Site& site, std::span<const FrameFit> frames, const ScenePrior& prior,
                                 const SceneModel& model) {
  const int size = scene_parameters(site.markers.size());
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(size, size);
  for (const FrameFit& f : frames) {
    if (f.ok) information += f.scene_information;
  }
  std::vector<int> used;
  const auto take = [&](int index, bool is_free, double u) {
    if (!is_free || !(u > 0.0)) return;
    information(index, index) += 1.0 / (u * u);
    used.push_back(index);
  };
  const auto common = free_common(model);
  const auto u_common = uncertainties_of(prior);
  for (int k = 0; k < kCommonParameters; ++k)
    take(k, common[static_cast<std::size_t>(k)], u_common[static_cast<std::size_t>(k)]);
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    const auto shape = free_shape(model, site.markers[i].role);
    for (int k = 0; k < kShapeParameters; ++k)
      take(shape_row(i, k), shape[static_cast<std::size_t>(k)], prior.u_markers[i].value[static_cast<std::size_t>(k)]);
  }
  const auto n = static_cast<Eigen::Index>(used.size());
  Eigen::MatrixXd small(n, n);
  Eigen::VectorXd scale(n);
  for (Eigen::Index a = 0; a < n; ++a)
    scale(a) = 1.0 / std::sqrt(information(used[static_cast<std::size_t>(a)], used[static_cast<std::size_t>(a)]));
  for (Eigen::Index a = 0; a < n; ++a) {
    for (Eigen::Index b = 0; b < n; ++b)
      small(a, b) =
          scale(a) * scale(b) * information(used[static_cast<std::size_t>(a)], used[static_cast<std::size_t>(b)]);
  }
  const Eigen::MatrixXd inverse = small.ldlt().solve(Eigen::MatrixXd::Identity(n, n));
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(size, size);
  for (Eigen::Index a = 0; a < n; ++a) {
    for (Eigen::Index b = 0; b < n; ++b)
      covariance(used[static_cast<std::size_t>(a)], used[static_cast<std::size_t>(b)]) =
          scale(a) * scale(b) * inverse(a, b);
  }
  return covariance;
}

}  // namespace moiregauge::internal
