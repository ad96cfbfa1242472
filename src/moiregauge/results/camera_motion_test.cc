// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/camera_motion.h"

#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "moiregauge/geometry/pose.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

Camera camera_of_the_rig() {
  return {.width = 1024, .height = 512, .fx = 3478.0, .fy = 3478.0, .cx = 511.5, .cy = 255.5};
}

Observation seen_from(const Pose& pose, long frame) {
  Observation seen;
  seen.frame = frame;
  seen.time_s = 0.1 * static_cast<double>(frame);
  seen.references_seen = true;
  seen.stage1 = seen.stage2 = view_of(pose, camera_of_the_rig());
  return seen;
}

Reference four_circles(const Pose& pose) {
  Reference reference;
  reference.seen = seen_from(pose, 0);
  for (const BoardPoint p : {BoardPoint{-128, 40}, BoardPoint{128, 40}, BoardPoint{-128, -40}, BoardPoint{128, -40}})
    reference.circles.push_back({0, p, {}, 0.01});
  return reference;
}

// A rotation by 0.4 degrees about x and -0.3 about z, for a board that is already tilted in the reference frame. Both
// angles are parts of one rotation.
TEST(CameraMotion, GivesTheRotationSinceTheReferenceFrame) {
  const Eigen::Vector3d slant(0.05, -0.1, 0.02), turn(radians_from_degrees(0.4), 0.0, radians_from_degrees(-0.3));
  const auto pose_turned_by = [](const Eigen::Matrix3d& r) {
    const Eigen::AngleAxisd by(r);
    const Eigen::Vector3d axis = by.angle() * by.axis();
    return Pose{{axis.x(), axis.y(), axis.z()}, {1.0, 2.0, 1200.0}};
  };
  const Eigen::Matrix3d at_first = Eigen::AngleAxisd(slant.norm(), slant.normalized()).toRotationMatrix();
  const Eigen::Matrix3d later = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix() * at_first;
  Observation lost;
  lost.frame = 2;
  const auto motion = camera_motion(four_circles(pose_turned_by(at_first)), {seen_from(pose_turned_by(later), 1), lost},
                                    camera_of_the_rig());
  ASSERT_EQ(motion.turn_x_deg.size(), 2U);
  EXPECT_NEAR(motion.turn_x_deg[0], 0.4, 1e-9);
  EXPECT_NEAR(motion.turn_y_deg[0], 0.0, 1e-9);
  EXPECT_NEAR(motion.turn_z_deg[0], -0.3, 1e-9);
  EXPECT_TRUE(std::isnan(motion.turn_x_deg[1]) && std::isnan(motion.shift_x_px[1]));
}

// A camera that shifts by 6 mm to the left at 1200 mm sees the board move to the right by f 6 / 1200 px.
TEST(CameraMotion, GivesTheShiftInPixelsWithoutACamera) {
  const auto motion =
      camera_motion(four_circles({{}, {0.0, 0.0, 1200.0}}), {seen_from({{}, {6.0, -3.0, 1200.0}}, 1)}, {});
  EXPECT_NEAR(motion.shift_x_px[0], 3478.0 * 6.0 / 1200.0, 1e-9);
  EXPECT_NEAR(motion.shift_y_px[0], 3478.0 * -3.0 / 1200.0, 1e-9);
  EXPECT_TRUE(motion.turn_x_deg.empty());
}

// With compressed footage `precise` may solve the positions and no lens. The focal length is then its start value.
TEST(KnownCamera, RequiresADeterminedFocalLength) {
  Reference reference;
  Scene scene;
  scene.solved = true;
  scene.camera = camera_of_the_rig();
  EXPECT_FALSE(known_camera(reference, scene));
  scene.model.radial = true;
  scene.covariance = Eigen::MatrixXd::Zero(kCommonParameters, kCommonParameters);
  scene.covariance(0, 0) = 400.0 * 400.0;
  EXPECT_FALSE(known_camera(reference, scene));  // u of 12 %
  scene.covariance(0, 0) = 3.0 * 3.0;
  EXPECT_EQ(known_camera(reference, scene).value().fx, 3478.0);
  reference.lens = camera_of_the_rig();
  EXPECT_EQ(known_camera(reference, std::nullopt).value().fx, 3478.0);
}

}  // namespace
}  // namespace moiregauge::internal
