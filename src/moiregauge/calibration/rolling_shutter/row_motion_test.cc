// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/rolling_shutter/row_motion.h"

#include <cmath>

#include <gtest/gtest.h>

#include "moiregauge/calibration/scene/frame_fit.h"
#include "moiregauge/calibration/scene/patch_residual.h"
#include "moiregauge/calibration/scene/rig_for_tests.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

using test::kNoise, test::kPitch, test::rig;

constexpr double kReadout = 0.02, kZ = 1200.0;

Scene scene_of(const Site& site) {
  Scene scene;
  scene.camera = {4104, 1012, 3478.26, 3478.26, 2051.5, 505.5, -0.02, 0, 0, 0, 0};
  scene.markers.resize(site.markers.size());
  return scene;
}

// Projects every point at the time of its own row, which is found by iteration.
BundleFrame rolling(const Site& site, const Scene& scene, const Pose& pose, const FrameMotion& motion) {
  BundleFrame frame;
  frame.pose = pose;
  const CommonNumbers camera = numbers_of(scene);
  for (const Marker& m : site.markers) {
    PatchFit fit;
    for (std::size_t n = 0; n < kPatchPoints; ++n) {
      const double x = (static_cast<double>(n % 3) - 1.0) * m.grating->width_mm / 3.0;
      const double y = (static_cast<double>(n / 3) - 1.0) * m.grating->height_mm / 3.0;
      double delay = 0.0;
      for (int pass = 0; pass < 20; ++pass) {
        PathPlace place = path_place(pose, pose);
        for (int k = 0; k < kPathParameters; ++k) {
          const PathPoint& p = motion.camera[static_cast<std::size_t>(k)];
          place(k) += delay * (p.rate + 0.5 * delay * p.acceleration);
        }
        const Pose then = pose_at(place, pose);
        const std::array<double, 6> numbers{then.turn[0],  then.turn[1],  then.turn[2],
                                            then.shift[0], then.shift[1], then.shift[2]};
        const auto image =
            projected(camera.data(), numbers.data(), {m.grating->centre.x + x, m.grating->centre.y + y, 0.0});
        fit.image[n] = {image[0], image[1]};
        delay = kReadout * share_of_row(fit.image[n], scene.camera, ReadoutDirection::kDown);
      }
      fit.print[n] = {x / kPitch, y / kPitch};
    }
    fit.information = PatchInformation::Identity() / (kNoise * kNoise);
    frame.points.emplace_back(fit);
    frame.shift.push_back({});
  }
  return frame;
}

const Pose kPose{{0.01, -0.02, 0.03}, {5.0, -3.0, kZ}};

TEST(RowMotion, PredictedMotionIsRemovedExactly) {
  const Site site = rig();
  const Scene scene = scene_of(site);
  FrameMotion motion;
  for (std::size_t k = 0; k < motion.camera.size(); ++k)
    motion.camera[k].rate = 0.05 + 0.01 * static_cast<double>(k), motion.camera[k].acceleration = 1.0;
  const BundleFrame read = rolling(site, scene, kPose, motion);
  EXPECT_GT(fit_frame(site, scene, read).chi2_sum, 1e4);
  const FrameFit fit =
      fit_frame(site, scene, to_frame_time(site, scene, read, {motion, kPose}, {kReadout, ReadoutDirection::kDown}));
  ASSERT_TRUE(fit.ok);
  EXPECT_LT(fit.chi2_sum, 1e-6);
  EXPECT_NEAR(fit.shift[4].x, 0.0, 1e-5);
  EXPECT_NEAR(fit.shift[4].y, 0.0, 1e-5);
}

// The motion is not predicted, but allowed for. The points absorb a constant rate except for 1e-3 of it, a second-order
// effect.
TEST(RowMotion, AConstantRateIsAbsorbedByTheFramesOwnPoints) {
  const Site site = rig();
  const Scene scene = scene_of(site);
  FrameMotion truth, allowed;
  truth.camera[2].rate = 0.1;
  truth.camera[3].rate = -0.05;
  for (PathPoint& p : allowed.camera) p.covariance = Eigen::Vector2d(1.0, 1e-8).asDiagonal();
  const BundleFrame read = rolling(site, scene, kPose, truth);
  const double at_once = fit_frame(site, scene, read).shift[4].x;
  EXPECT_GT(std::abs(at_once), 0.05) << "roll passes for a tilt";
  const FrameFit fit =
      fit_frame(site, scene, to_frame_time(site, scene, read, {allowed, kPose}, {kReadout, ReadoutDirection::kDown}));
  EXPECT_NEAR(fit.motion(2), 0.1, 0.002);
  EXPECT_NEAR(fit.motion(3), -0.05, 0.002);
  EXPECT_LT(std::abs(fit.shift[4].x), 0.02 * std::abs(at_once));
}

// docs/methods/precise/rolling-shutter.md: e = a dt^2 / 2, with the mean square delays of references and target.
TEST(RowMotion, AnAccelerationLeavesHalfOfItTimesTheDelaySquared) {
  const Site site = rig();
  const Scene scene = scene_of(site);
  FrameMotion motion;
  motion.camera[4].acceleration = 20.0;  // y / z, 1/s^2
  const BundleFrame read = rolling(site, scene, {{0, 0, 0}, {0, 0, kZ}}, motion);
  const auto square = [&](std::size_t i) {
    double sum = 0.0;
    for (const ImagePoint p : read.points[i]->image)
      sum += std::pow(kReadout * share_of_row(p, scene.camera, ReadoutDirection::kDown), 2) / kPatchPoints;
    return sum;
  };
  const double references = 0.25 * (square(0) + square(1) + square(2) + square(3));
  const double expected = 0.5 * 20.0 * kZ * (references - square(4));  // down in the picture is down on the board
  EXPECT_NEAR(fit_frame(site, scene, read).shift[4].y, expected, 0.1 * std::abs(expected));
}

TEST(RowMotion, PathCoordinatesRestoreThePose) {
  const Pose reference{{0.3, 0.1, 2.9}, {10.0, 20.0, 900.0}};
  const PathPlace place = path_place(kPose, reference);
  const Pose again = pose_at(place, reference);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(again.turn[k], kPose.turn[k], 1e-12);
    EXPECT_NEAR(again.shift[k], kPose.shift[k], 1e-9);
  }
}

}  // namespace
}  // namespace moiregauge::internal
