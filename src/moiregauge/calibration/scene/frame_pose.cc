// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/scene/frame_pose.h"

#include <array>
#include <cmath>
#include <span>
#include <vector>

namespace moiregauge::internal {

namespace {

// Fits the homography through the four outermost points, or through all if three of the four are collinear. It only
// starts a fit.
std::optional<IdealFromBoard> rough_view(const std::vector<BoardPoint>& board, const std::vector<IdealPoint>& ideal) {
  std::array<std::size_t, 4> outermost{};
  const auto towards = [&](std::size_t corner, std::size_t k) {
    return (corner % 2 == 0 ? 1.0 : -1.0) * board[k].x + (corner / 2 == 0 ? 1.0 : -1.0) * board[k].y;
  };
  for (std::size_t corner = 0; corner < outermost.size(); ++corner) {
    for (std::size_t k = 1; k < board.size(); ++k)
      if (towards(corner, k) > towards(corner, outermost[corner])) outermost[corner] = k;
  }
  std::array<BoardPoint, 4> from;
  std::array<IdealPoint, 4> to;
  for (std::size_t corner = 0; corner < outermost.size(); ++corner)
    from[corner] = board[outermost[corner]], to[corner] = ideal[outermost[corner]];
  auto h =
      fit_homography<frame::Ideal, frame::Board>(std::span<const BoardPoint>(from), std::span<const IdealPoint>(to));
  if (!h) h = fit_homography<frame::Ideal, frame::Board>(board, ideal);
  return h ? std::optional(IdealFromBoard(*h)) : std::nullopt;
}

}  // namespace

std::optional<Pose> pose_of(const Site& site, const Scene& scene, const BundleFrame& frame) {
  std::vector<BoardPoint> board;
  std::vector<IdealPoint> ideal;
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    if (!frame.points[i] || !site.markers[i].grating || site.markers[i].role != Role::kReference) continue;
    const Grating& grating = *site.markers[i].grating;
    const auto& shape = scene.markers[i].value;
    const double angle = grating.angle_rad + shape[MarkerShape::kRotation];
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
  const auto view = rough_view(board, ideal);
  return view ? std::optional(pose_of(*view, scene.camera)) : std::nullopt;
}

}  // namespace moiregauge::internal
