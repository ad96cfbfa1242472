// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/camera_motion.h"

#include <cmath>

#include <Eigen/Geometry>

#include "moiregauge/geometry/pose.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

Matrix3 rotation_of(const IdealFromBoard& view, const Camera& camera) {
  const Pose pose = pose_of(view, camera);
  const Eigen::Vector3d axis(pose.turn[0], pose.turn[1], pose.turn[2]);
  const double angle = axis.norm();
  return angle > 0.0 ? Matrix3(Eigen::AngleAxisd(angle, axis / angle)) : Matrix3(Matrix3::Identity());
}

BoardPoint middle_of(const Reference& reference) {
  BoardPoint middle;
  const double share = 1.0 / static_cast<double>(reference.circles.size());
  for (const CirclePoint& point : reference.circles) middle = middle + share * (point.board - BoardPoint{});
  return middle;
}

}  // namespace

CameraMotion camera_motion(const Reference& reference, const Observations& observations,
                           const std::optional<Camera>& camera) {
  CameraMotion motion;
  if (reference.circles.empty()) return motion;
  const BoardPoint middle = middle_of(reference);
  const ImagePoint then = View{reference.seen.stage2, reference.lens}(middle);
  const Matrix3 turned_then = camera ? rotation_of(reference.seen.stage2, *camera) : Matrix3(Matrix3::Identity());
  for (const Observation& seen : observations) {
    motion.frame.push_back(seen.frame);
    motion.time_s.push_back(seen.time_s);
    const bool is_seen = seen.references_seen && !seen.decode_error;
    const ImagePoint now = is_seen ? View{seen.stage2, reference.lens}(middle) : ImagePoint{kNotMeasured, kNotMeasured};
    motion.shift_x_px.push_back(now.x - then.x);
    motion.shift_y_px.push_back(now.y - then.y);
    if (!camera) continue;
    Eigen::Vector3d turn = Eigen::Vector3d::Constant(kNotMeasured);
    if (is_seen) {
      const Eigen::AngleAxisd by(Matrix3(rotation_of(seen.stage2, *camera) * turned_then.transpose()));
      turn = by.angle() * by.axis();
    }
    motion.turn_x_deg.push_back(degrees_from_radians(turn.x()));
    motion.turn_y_deg.push_back(degrees_from_radians(turn.y()));
    motion.turn_z_deg.push_back(degrees_from_radians(turn.z()));
  }
  return motion;
}

std::optional<Camera> known_camera(const Reference& reference, const std::optional<Scene>& scene) {
  if (scene && determines_camera(*scene)) return scene->camera;
  if (reference.lens.fx != 1.0) return reference.lens;
  return std::nullopt;
}

}  // namespace moiregauge::internal
