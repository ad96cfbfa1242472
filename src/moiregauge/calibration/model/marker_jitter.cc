// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/model/marker_jitter.h"

#include <cmath>
#include <vector>

#include <Eigen/Householder>

#include "moiregauge/calibration/model/chi2.h"
#include "moiregauge/calibration/scene/patch_residual.h"

namespace moiregauge::internal {
namespace {

constexpr int kPose = 6;
using Shift18 = Eigen::Matrix<double, PatchResidual::kSize, 2>;

// Returns an orthonormal basis of two columns by Householder reflections. Eigen's HouseholderQR, which has the same bits,
// takes longer to compile.
Shift18 basis_of(Shift18 columns) {
  constexpr Eigen::Index kSize = PatchResidual::kSize;
  Eigen::Vector2d factor, workspace;
  for (Eigen::Index k = 0; k < 2; ++k) {
    double diagonal = 0.0;
    columns.col(k).tail(kSize - k).makeHouseholderInPlace(factor(k), diagonal);
    columns(k, k) = diagonal;
    columns.bottomRightCorner(kSize - k, 1 - k)
        .applyHouseholderOnTheLeft(columns.col(k).tail(kSize - k - 1), factor(k), workspace.data());
  }
  Shift18 basis = Shift18::Identity();
  for (Eigen::Index k = 1; k >= 0; --k)
    basis.bottomRightCorner(kSize - k, 2)
        .applyHouseholderOnTheLeft(columns.col(k).tail(kSize - k - 1), factor(k), workspace.data());
  return basis;
}

// References of one frame, each in the two coordinates in which its shift shows (projected by Q'). `by_frame`:
// columns of pose and motion. `by_scene`: columns of the scene, after eliminating these. `by_shift`: effect of a shift
// by 1 mm.
struct Common {
  Eigen::VectorXd residual;
  Eigen::MatrixXd by_frame, by_scene, by_shift;
  Eigen::MatrixXd covariance;  // covariance of pose and motion
};

Common common_of(const Site& site, const Scene& scene, const BundleFrame& frame, const FrameFit& fit) {
  std::vector<std::size_t> seen;
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    if (frame.points[i] && site.markers[i].grating && site.markers[i].role == Role::kReference) seen.push_back(i);
  }
  const auto rows = static_cast<Eigen::Index>(2 * seen.size());
  Common c{Eigen::VectorXd::Zero(rows), Eigen::MatrixXd::Zero(rows, fit.pose_covariance.rows()),
           Eigen::MatrixXd::Zero(rows, scene_parameters(site.markers.size())), Eigen::MatrixXd::Zero(rows, rows),
           fit.pose_covariance};
  const CommonNumbers camera = numbers_of(scene);
  const TurnedPose pose(fit.pose);
  for (std::size_t k = 0; k < seen.size(); ++k) {
    const std::size_t i = seen[k];
    const auto row = static_cast<Eigen::Index>(2 * k);
    const PatchResidual patch(*frame.points[i], site.markers[i]);
    auto design = patch.design(camera, scene.markers[i], pose, fit.shift[i]);
    const Shift18 q = basis_of(design.middleCols<2>(PatchColumn::kShape));
    if (frame.rows) {
      const auto by_motion = (patch.root() * frame.rows->by_marker[i].leftCols<kMotionParameters>()).eval();
      design.col(PatchColumn::kResidual) += by_motion * fit.motion;
      c.by_frame.block<2, kMotionParameters>(row, kPose) = q.transpose() * by_motion;
    }
    const Eigen::Matrix<double, 2, PatchColumn::kColumns> along = q.transpose() * design;
    c.residual.segment<2>(row) = along.col(PatchColumn::kResidual);
    c.by_frame.block<2, kPose>(row, 0) = along.middleCols<kPose>(PatchColumn::kPose);
    c.by_shift.block<2, 2>(row, row) = along.middleCols<2>(PatchColumn::kShape);
    c.by_scene.block<2, kCommonParameters>(row, 0) = along.leftCols<kCommonParameters>();
    c.by_scene.block<2, kShapeParameters>(row, shape_row(i, 0)) =
        along.middleCols<kShapeParameters>(PatchColumn::kShape);
  }
  c.by_scene += c.by_frame * fit.pose_sensitivity;
  return c;
}

}  // namespace

double marker_jitter_mm(const Site& site, const BundleSolution& solution, std::span<const FrameFit> fits,
                        const ScenePrior& prior, double already) {
  const auto& [scene, frames] = solution;
  const Eigen::MatrixXd covariance = scene_covariance(site, fits, prior, scene.model);
  const auto parameters = covariance.rows();
  std::vector<Common> all;
  // Information about the scene that a jitter of 1 mm imitates.
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(parameters, parameters);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    if (!fits[k].ok) continue;
    all.push_back(common_of(site, scene, frames[k], fits[k]));
    const Eigen::MatrixXd s = all.back().by_scene.transpose() * all.back().by_shift;
    information.noalias() += s * s.transpose();
  }
  double chi2 = 0.0, dof = 0.0, per_wander = 0.0;
  for (const Common& c : all) {
    const Eigen::MatrixXd by_scene = c.by_scene * covariance;  // Q' S C
    const Eigen::MatrixXd left = Eigen::MatrixXd::Identity(c.residual.size(), c.residual.size()) -
                                 c.by_frame * c.covariance * c.by_frame.transpose() - by_scene * c.by_scene.transpose();
    const Eigen::MatrixXd own = c.by_scene.transpose() * c.by_shift;
    chi2 += c.residual.squaredNorm();
    dof += left.trace();
    per_wander += (left * c.by_shift).squaredNorm() + (by_scene * information).cwiseProduct(by_scene).sum() -
                  (by_scene * own).squaredNorm();  // by the other frames
  }
  if (!(dof > 0.0 && per_wander > 0.0)) return already;
  if (already == 0.0 && chi2 <= chi2_upper_quantile(dof)) return 0.0;
  return std::sqrt(std::max(0.0, already * already + (chi2 - dof) / per_wander));
}

}  // namespace moiregauge::internal
