// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/pose.h"

#include <cmath>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/SVD>

namespace moiregauge {

Pose pose_of(const IdealFromBoard& view, const Camera& camera) {
  Matrix3 k;
  k << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1;
  // Columns: what the board's x, its y (downwards) and its origin become, up to one scale.
  Matrix3 h = k.inverse() * view.matrix();
  h.col(1) *= -1.0;
  const double scale = 2.0 / (h.col(0).norm() + h.col(1).norm());
  h *= h(2, 2) < 0.0 ? -scale : scale;  // in front of the camera
  Matrix3 r;
  r << h.col(0), h.col(1), h.col(0).cross(h.col(1));
  const Eigen::JacobiSVD<Matrix3> svd(r, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix3 nearest = svd.matrixU() * svd.matrixV().transpose();
  if (nearest.determinant() < 0.0)
    nearest = svd.matrixU() * Eigen::Vector3d(1, 1, -1).asDiagonal() * svd.matrixV().transpose();
  const Eigen::AngleAxisd turn(nearest);
  const Eigen::Vector3d axis = turn.angle() * turn.axis();
  return {{axis.x(), axis.y(), axis.z()}, {h(0, 2), h(1, 2), h(2, 2)}};
}

std::optional<Pose> pose_of(const Site& site, const Scene& scene, const BundleFrame& frame) {
  std::vector<BoardPoint> board;
  std::vector<IdealPoint> ideal;
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    if (!frame.points[i] || !site.markers[i].grating || site.markers[i].role != Role::kReference) continue;
    const Grating& grating = *site.markers[i].grating;
    const auto& shape = scene.markers[i].value;
    const double angle = grating.angle_rad + shape[MarkerShape::kTurn];
    const double pitch = grating.pitch_mm * (1.0 + shape[MarkerShape::kScale]);
    const double c = pitch * std::cos(angle), s = pitch * std::sin(angle);
    for (std::size_t n = 0; n < kPatchPoints; ++n) {
      const PrintPoint p = frame.points[i]->print[n];
      board.push_back({grating.centre.x + shape[MarkerShape::kX] + c * p.x - s * p.y,
                       grating.centre.y + shape[MarkerShape::kY] + s * p.x + c * p.y});
      ideal.push_back(scene.camera.undistort(frame.points[i]->image[n]));
    }
  }
  if (board.empty()) return std::nullopt;
  const auto h = fit_homography<frame::Ideal, frame::Board>(board, ideal);
  if (!h) return std::nullopt;
  return pose_of(IdealFromBoard(*h), scene.camera);
}

}  // namespace moiregauge
