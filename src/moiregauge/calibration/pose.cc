// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/pose.h"

#include <cmath>
#include <vector>

namespace moiregauge {

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
