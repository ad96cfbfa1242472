// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/planning/recording_plan.h"

#include <cmath>

#include <gtest/gtest.h>

#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

Marker marker(const char* name, Role role, BoardPoint centre, double size) {
  Marker m;
  m.name = name;
  m.role = role;
  m.grating =
      Grating{.centre = centre, .width_mm = size, .height_mm = size, .pitch_mm = 10.0, .pattern = Pattern::kGrid};
  return m;
}

// The rig of docs/cli/simulate.md.
RecordingSetup rig(double a = 340.0, double b = 28.0) {
  RecordingSetup setup;
  setup.site.markers = {marker("NW", Role::kReference, {-a, b}, 40.0), marker("NE", Role::kReference, {a, b}, 40.0),
                        marker("SW", Role::kReference, {-a, -b}, 40.0), marker("SE", Role::kReference, {a, -b}, 40.0),
                        marker("mid", Role::kTarget, {0.0, 0.0}, 60.0)};
  setup.camera = {.width = 4104, .height = 1012, .fx = 3478.26, .fy = 3478.26, .cx = 2051.5, .cy = 505.5};
  setup.distance_mm = 1200.0;
  return setup;
}

// Values of the design for the rig: 0.46 um in dy and 2.5 um in dx per frame, by the fundamentals of whole gratings.
TEST(RecordingPlan, TheBoundOfTheRigIsThatOfTheDesign) {
  const auto targets = planned_targets(rig());
  ASSERT_EQ(targets.size(), 1u);
  EXPECT_NEAR(1000.0 * targets[0].phase_bound.y, 0.46, 0.01);
  EXPECT_NEAR(1000.0 * targets[0].phase_bound.x, 2.5, 0.05);
}

// The codec's part is that of codec_error.h for the slopes of the planned grating. It adds to the noise.
TEST(RecordingPlan, CompressionAddsTheErrorOfTheDeadZone) {
  RecordingSetup setup = rig(340.0, 340.0);
  const PlannedTarget raw = planned_targets(setup)[0];
  EXPECT_EQ(raw.codec.x, 0.0);
  setup.codec = {kUsualStep, true};
  const PlannedTarget lossy = planned_targets(setup)[0];
  EXPECT_NEAR(lossy.u.x, std::hypot(raw.u.x, lossy.codec.x), 1e-12);
  EXPECT_GT(lossy.u.x, 5.0 * raw.u.x);
  EXPECT_LT(lossy.codec.x, 0.13 / px_per_mm(setup) * 1.2);  // kMaxLag_px, and the part of the references
  setup.codec.predicted = false;                            // key frames only: errors average out over the grating
  EXPECT_LT(planned_targets(setup)[0].codec.x, 0.2 * lossy.codec.x);
}

// Small gratings far apart act as points: their size hardly matters. The bound of one grating is sd = p / (2 pi) (s /
// a) sqrt(2 / N). For crossed lines a = 2 contrast / (2 pi), before the lens acts. For four references at (+-a, +-b)
// see reference_weights.h.
TEST(RecordingPlan, BoundsFollowTheClosedForms) {
  RecordingSetup setup = rig(3400.0, 280.0);
  setup.optics.psf_sigma_px = 0.0;
  const double pitch_px = 10.0 * 3478.26 / 1200.0, pixel = std::sin(kPi / pitch_px) / (kPi / pitch_px);
  const double amplitude = 170.0 / kPi * pixel, sigma = std::sqrt(1.5 * 1.5 + 1.0 / 12.0);
  const auto own = [&](double size) {
    const double side_px = size * 3478.26 / 1200.0;
    return 10.0 / kTwoPi * sigma / amplitude * std::sqrt(2.0) / side_px;
  };
  const double s = own(40.0), ratio = 3400.0 / 280.0;
  const auto bound = planned_targets(setup)[0].phase_bound;
  EXPECT_NEAR(bound.y / std::hypot(own(60.0), 0.5 * s * std::sqrt(1.0 + 1.0 / (ratio * ratio))), 1.0, 0.01);
  EXPECT_NEAR(bound.x / std::hypot(own(60.0), 0.5 * s * std::sqrt(1.0 + ratio * ratio)), 1.0, 0.01);
}

TEST(PlannedPrint, AmplitudesAreThoseOfThePatterns) {
  const PlannedOptics sharp{.contrast = 100.0, .psf_sigma_px = 0.0};
  const auto pixel = [](int m) { return m == 0 ? 1.0 : std::sin(kPi * m / 40.0) / (kPi * m / 40.0); };
  const auto c = [&](Pattern pattern, int m, int n) {
    return planned_print(pattern, 40.0, sharp).coefficient(m, n).real() / (pixel(m) * pixel(n));
  };
  EXPECT_NEAR(c(Pattern::kGrid, 1, 0), -100.0 / (2.0 * kPi), 1e-4);
  EXPECT_NEAR(c(Pattern::kSquares, 1, 0), -100.0 / (2.0 * kPi), 1e-4);
  EXPECT_NEAR(c(Pattern::kGrid, 3, 0), 100.0 / (6.0 * kPi), 1e-4);
  EXPECT_NEAR(c(Pattern::kCheckerboard, 1, 0), 0.0, 1e-9);
  EXPECT_NEAR(c(Pattern::kCheckerboard, 1, 1), -200.0 / (kPi * kPi), 1e-4);
  EXPECT_NEAR(c(Pattern::kLinesX, 1, 0), -100.0 / kPi, 1e-4);
  EXPECT_NEAR(c(Pattern::kCosine, 1, 0), 12.5, 1e-4);
  EXPECT_NEAR(c(Pattern::kDots, 1, 0), -25.0 * std::cyl_bessel_j(1.0, 0.5 * kPi), 1e-4);
}

// Blur by b px reduces the contrast by sinc(b / P), to zero at one pitch.
TEST(PlannedPrint, BlurOfOnePitchLeavesNothing) {
  const auto left = [](double blur) {
    return planned_print(Pattern::kLinesX, 20.0, {.blur_x_px = blur}).coefficient(1, 0).real() /
           planned_print(Pattern::kLinesX, 20.0, {}).coefficient(1, 0).real();
  };
  EXPECT_NEAR(left(20.0), 0.0, 1e-12);
  EXPECT_NEAR(left(10.0), 2.0 / kPi, 1e-12);
}

TEST(RecordingPlan, BlurIsSpeedTimesExposure) {
  RecordingSetup setup = rig();
  setup.exposure_s = 0.01;
  setup.target_swing = Swing{1.0, 5.0};
  setup.camera_swing = Swing{radians_from_degrees(0.01), 10.0};
  EXPECT_NEAR(planned_blur(setup).target_px, kTwoPi * 5.0 * 1.0 * 0.01 * 3478.26 / 1200.0, 1e-9);
  EXPECT_NEAR(planned_blur(setup).camera_px, kTwoPi * 10.0 * radians_from_degrees(0.01) * 0.01 * 3478.26, 1e-9);
}

TEST(RecordingPlan, TheRoomForRotationEndsWithACornerAtTheEdge) {
  RecordingSetup setup = rig();
  const auto room = turning_room(setup);
  // Pan: the outer corner (360 mm) moves outwards on the far side. The room is the angle to the image edge minus that
  // to the corner.
  const double edge = std::atan(2051.5 / 3478.26), corner = std::atan(360.0 / 1200.0);
  EXPECT_NEAR(room.pan, edge - corner, 1e-3);
  setup.camera.width = 1000, setup.camera.cx = 499.5;
  EXPECT_LT(turning_room(setup).pan, 0.0);
}

// Verify the advice with the bound of the moved layout.
TEST(RecordingPlan, AFlatLayoutGetsAdviceAndItsGain) {
  const auto better = better_layout(rig());
  ASSERT_TRUE(better);
  EXPECT_EQ(better->moved, (std::vector<std::string>{"NW", "NE"}));
  EXPECT_GT(better->by.y, 0.0);
  EXPECT_LT(better->u_after.x, 0.7 * better->u_before.x);
  RecordingSetup moved = rig();
  for (const std::size_t i : {0u, 1u}) moved.site.markers[i].grating->centre.y += better->by.y;
  EXPECT_NEAR(planned_targets(moved)[0].u.x, better->u_after.x, 1e-12);
  EXPECT_GE(turning_room(moved).tilt, 0.0);
  EXPECT_FALSE(better_layout(rig(340.0, 200.0)));
}

TEST(RecordingPlan, LaterRowsSeeAMovedCamera) {
  RecordingSetup setup = rig();
  setup.readout_s = 0.02;
  setup.camera_swing = Swing{radians_from_degrees(0.02), 40.0};
  const double lag = 28.0 * 3478.26 / 1200.0 * 0.02 / 1012.0;
  const double acceleration_mm = std::pow(kTwoPi * 40.0, 2) * radians_from_degrees(0.02) * 1200.0;
  EXPECT_NEAR(shutter_error(setup).lag_s, lag, 1e-12);
  EXPECT_NEAR(shutter_error(setup).camera_mm, 0.5 * acceleration_mm * lag * lag, 1e-12);
  // A sine has an rms of its amplitude by sqrt 2, which adds in quadrature to the other parts of u along both axes.
  RecordingSetup global = setup;
  global.readout_s = 0.0;
  const PlannedTarget rolls = planned_targets(setup)[0], still = planned_targets(global)[0];
  EXPECT_NEAR(rolls.shutter, 0.5 * acceleration_mm * lag * lag / std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(rolls.u.x, std::hypot(still.u.x, rolls.shutter), 1e-12);
  EXPECT_NEAR(rolls.u.y, std::hypot(still.u.y, rolls.shutter), 1e-12);
  EXPECT_EQ(still.shutter, 0.0);
}

}  // namespace
}  // namespace moiregauge::internal
