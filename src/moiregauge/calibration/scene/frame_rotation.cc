// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/scene/frame_rotation.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "moiregauge/calibration/scene/patch_residual.h"

namespace moiregauge::internal {
namespace {

// Least information about a rotation that counts, 1/rad^2: u = 0.1 rad. Chosen.
constexpr double kMinInformation = 100.0;

// Normal equations of the rotations (index r), the frame's other unknowns (f), the scene (g) and the readout time (b).
struct RotationNormal {
  Eigen::VectorXd rr, right, rb;
  Eigen::MatrixXd rf, rg;
};

using RotationColumn = Eigen::Matrix<double, PatchResidual::kSize, 1>;

struct TargetPatch {
  std::size_t marker = 0;
  PatchResidual::Design design;
  RowDesign::Columns rows;  // whitened; only for a rolling shutter
};

void add_target(RotationNormal& n, Eigen::Index r, const TargetPatch& patch, const FrameFit& fit, bool is_rolling) {
  const auto& design = patch.design;
  const RotationColumn a = design.col(PatchColumn::kShape + MarkerShape::kRotation);
  n.rr(r) = a.squaredNorm();
  n.right(r) = a.dot(design.col(PatchColumn::kResidual));
  n.rf.row(r).head<6>() = a.transpose() * design.middleCols<6>(PatchColumn::kPose);
  n.rf.row(r).segment<2>(fit.shift_row[patch.marker]) = a.transpose() * design.middleCols<2>(PatchColumn::kShape);
  n.rg.row(r).head<kCommonParameters>() = a.transpose() * design.leftCols<kCommonParameters>();
  n.rg.row(r).segment<kShapeParameters>(shape_row(patch.marker, 0)) =
      a.transpose() * design.middleCols<kShapeParameters>(PatchColumn::kShape);
  if (!is_rolling) return;
  n.rf.row(r).tail<kMotionParameters>() = a.transpose() * patch.rows.leftCols<kMotionParameters>();
  n.rb(r) = a.dot(patch.rows.col(kMotionParameters));
}

// Returns the gratings of the targets that the fit has shifts for.
std::vector<TargetPatch> target_patches(const Site& site, const Scene& scene, const BundleFrame& frame,
                                        const FrameFit& fit) {
  std::vector<TargetPatch> out;
  const CommonNumbers camera = numbers_of(scene);
  const TurnedPose pose(fit.pose);
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    if (fit.shift_row[i] < 0) continue;
    const PatchResidual patch(*frame.points[i], site.markers[i]);
    TargetPatch target;
    target.marker = i;
    target.design = patch.design(camera, scene.markers[i], pose, fit.shift[i]);
    if (frame.rows) {
      target.rows = patch.root() * frame.rows->by_marker[i];
      target.design.col(PatchColumn::kResidual) += target.rows.leftCols<kMotionParameters>() * fit.motion;
    }
    const RotationColumn a = target.design.col(PatchColumn::kShape + MarkerShape::kRotation);
    if (a.squaredNorm() > kMinInformation) out.push_back(std::move(target));
  }
  return out;
}

}  // namespace

FrameRotations fit_rotations(const Site& site, const Scene& scene, const BundleFrame& frame, const FrameFit& fit) {
  FrameRotations out;
  out.row.assign(site.markers.size(), -1);
  if (!fit.ok) return out;
  const auto targets = target_patches(site, scene, frame, fit);
  const auto size = static_cast<Eigen::Index>(targets.size());
  const Eigen::Index scene_size = scene_parameters(site.markers.size());
  RotationNormal n{Eigen::VectorXd::Zero(size), Eigen::VectorXd::Zero(size), Eigen::VectorXd::Zero(size),
                   Eigen::MatrixXd::Zero(size, fit.variance.size()), Eigen::MatrixXd::Zero(size, scene_size)};
  for (Eigen::Index r = 0; r < size; ++r)
    add_target(n, r, targets[static_cast<std::size_t>(r)], fit, frame.rows.has_value());
  const Eigen::MatrixXd information =
      Eigen::MatrixXd(n.rr.asDiagonal()) - n.rf * full_covariance(fit) * n.rf.transpose();
  const Eigen::LLT<Eigen::MatrixXd> root(information);
  if (size == 0 || root.info() != Eigen::Success) return out;
  for (Eigen::Index r = 0; r < size; ++r) out.row[targets[static_cast<std::size_t>(r)].marker] = static_cast<int>(r);
  out.angle_rad = -root.solve(n.right);
  const double chi2 = fit.chi2_sum + n.right.dot(out.angle_rad);
  const double dof = static_cast<double>(fit.dof - size);
  const double inflation = dof > 0.0 ? std::max(1.0, chi2 / dof) : 1.0;
  out.covariance = inflation * root.solve(Eigen::MatrixXd::Identity(size, size));
  out.sensitivity = -root.solve(n.rg + n.rf * full_sensitivity(fit));
  if (frame.rows) out.by_readout = -root.solve(n.rb + n.rf * fit.by_readout);
  return out;
}

}  // namespace moiregauge::internal
