// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/frame_fit.h"

#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "moiregauge/calibration/free_parameters.h"
#include "moiregauge/calibration/patch_residual.h"

namespace moiregauge {
namespace {

constexpr int kRows = PatchResidual::kSize;
constexpr int kShape = MarkerShape::kParameters;
constexpr int kPasses = 4;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

template <int kColumns>
using Jacobian = Eigen::Matrix<double, kRows, kColumns>;

// Of pose and shifts (f) and the scene's parameters (g).
struct Normal {
  Eigen::MatrixXd ff, fg, gg;
  Eigen::VectorXd rf;
};

Normal empty_normal(int rows, int globals) {
  return {Eigen::MatrixXd::Zero(rows, rows), Eigen::MatrixXd::Zero(rows, globals),
          Eigen::MatrixXd::Zero(globals, globals), Eigen::VectorXd::Zero(rows)};
}

// Adds the patch of marker i, whose shift has two rows from `shift_row` on unless that is negative; what concerns the
// scene only if `with_scene`.
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
  const auto column = [&](int k) { return k < kCameraParameters ? k : k + kShape * static_cast<int>(i); };
  const Jacobian<kCameraParameters + kShape> scene = design.leftCols<kCameraParameters + kShape>();
  const Eigen::Matrix<double, 8, kCameraParameters + kShape> fg = own.transpose() * scene;
  const Eigen::Matrix<double, kCameraParameters + kShape, kCameraParameters + kShape> gg = scene.transpose() * scene;
  for (int b = 0; b < kCameraParameters + kShape; ++b) {
    for (int a = 0; a < used; ++a) n.fg(row(a), column(b)) += fg(a, b);
    for (int a = 0; a < kCameraParameters + kShape; ++a) n.gg(column(a), column(b)) += gg(a, b);
  }
}

// Gauss and Newton's step; false when the patches do not determine it.
bool take_step(FrameFit& fit, const Normal& n) {
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
  return true;
}

}  // namespace

int scene_parameters(std::size_t markers) { return kCameraParameters + kShape * static_cast<int>(markers); }

FrameFit fit_frame(const Site& site, const Scene& scene, const BundleFrame& frame) {
  const std::size_t markers = site.markers.size();
  FrameFit fit;
  fit.pose = frame.pose;
  fit.shift.assign(markers, {kNaN, kNaN});
  fit.shift_row.assign(markers, -1);
  fit.chi2.assign(markers, kNaN);
  fit.own_information.assign(markers, Eigen::Matrix2d::Zero());
  int rows = 6, references = 0;
  std::vector<std::optional<PatchResidual>> patches(markers);
  for (std::size_t i = 0; i < markers; ++i) {
    if (!frame.points[i] || !site.markers[i].grating) continue;
    patches[i].emplace(*frame.points[i], *site.markers[i].grating);
    references += site.markers[i].role == Role::kReference;
    fit.shift[i] = {0, 0};
    if (site.markers[i].role == Role::kReference || frame.at_rest) continue;
    fit.shift[i] = frame.shift[i];
    fit.shift_row[i] = rows;
    rows += 2;
  }
  if (references < 3) return fit;
  const CameraNumbers camera = numbers_of(scene.camera);
  Normal n;
  for (int pass = 0; pass <= kPasses; ++pass) {
    const bool last = pass == kPasses;
    const TurnedPose pose(fit.pose);
    n = empty_normal(rows, last ? scene_parameters(markers) : 0);
    fit.chi2_sum = 0.0;
    fit.dof = -rows;
    for (std::size_t i = 0; i < markers; ++i) {
      if (!patches[i]) continue;
      const auto design = patches[i]->design(camera, scene.markers[i], pose, fit.shift[i]);
      add_patch(n, design, i, fit.shift_row[i], last);
      fit.chi2[i] = design.col(PatchColumn::kResidual).squaredNorm();
      fit.chi2_sum += fit.chi2[i];
      fit.dof += kRows;
      const auto by_shift = design.middleCols<2>(PatchColumn::kShape);
      fit.own_information[i] = by_shift.transpose() * by_shift;
    }
    for (int k = 6; k < rows; ++k) n.ff(k, k) += 1.0 / (kUnknownShift * kUnknownShift);
    if (!last && !take_step(fit, n)) return fit;
  }
  const Eigen::VectorXd scale = n.ff.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd inverse =
      (scale.asDiagonal() * n.ff * scale.asDiagonal()).ldlt().solve(Eigen::MatrixXd::Identity(rows, rows));
  fit.covariance = scale.asDiagonal() * inverse * scale.asDiagonal();
  fit.sensitivity = -fit.covariance * n.fg;
  fit.scene_information = n.gg + n.fg.transpose() * fit.sensitivity;
  fit.ok = std::isfinite(fit.chi2_sum);
  return fit;
}

double chi2_of_turning(const Site& site, const Scene& scene, const BundleFrame& frame, const FrameFit& fit) {
  if (!fit.ok) return 0.0;
  const auto rows = fit.covariance.rows();
  const CameraNumbers camera = numbers_of(scene.camera);
  const TurnedPose pose(fit.pose);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(rows + 3, rows + 3);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(rows + 3);
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    if (!frame.points[i] || !site.markers[i].grating) continue;
    const auto design =
        PatchResidual(*frame.points[i], *site.markers[i].grating).design(camera, scene.markers[i], pose, fit.shift[i]);
    // The patch is read at the time of its middle row.
    const double row = (frame.points[i]->image[kPatchPoints / 2].y - scene.camera.cy) / scene.camera.fx;
    Eigen::MatrixXd j = Eigen::MatrixXd::Zero(kRows, rows + 3);
    j.leftCols<6>() = design.middleCols<6>(PatchColumn::kPose);
    if (fit.shift_row[i] >= 0) j.middleCols<2>(fit.shift_row[i]) = design.middleCols<2>(PatchColumn::kShape);
    j.rightCols<3>() = row * j.leftCols<3>();
    normal.noalias() += j.transpose() * j;
    right.noalias() += j.transpose() * design.col(PatchColumn::kResidual);
  }
  for (Eigen::Index k = 6; k < rows; ++k) normal(k, k) += 1.0 / (kUnknownShift * kUnknownShift);
  const Eigen::VectorXd scale = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * normal * scale.asDiagonal();
  const Eigen::VectorXd r = scale.cwiseProduct(right);
  const auto explained = [&](Eigen::Index size) {
    return r.head(size).dot(scaled.topLeftCorner(size, size).ldlt().solve(r.head(size)));
  };
  return std::max(0.0, explained(rows + 3) - explained(rows));
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
  const auto camera = free_camera(model);
  for (int k = 0; k < kCameraParameters; ++k)
    take(k, camera[static_cast<std::size_t>(k)], prior.u_camera[static_cast<std::size_t>(k)]);
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    const auto shape = free_shape(model, site.markers[i].role);
    for (int k = 0; k < kShape; ++k)
      take(kCameraParameters + kShape * static_cast<int>(i) + k, shape[static_cast<std::size_t>(k)],
           prior.u_markers[i].value[static_cast<std::size_t>(k)]);
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

}  // namespace moiregauge
