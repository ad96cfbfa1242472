// SPDX-License-Identifier: Apache-2.0
// Tests the errors that the published method must leave, in closed form (docs/methods/two-stage.md). They are errors of
// the method and not of pixels.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "paper/exact_points.h"

namespace moiregauge::internal {
namespace {

using simulator::Scenario;

// Returns the rig rotated by 0.1 degree about x, with instant exposure and a fixed target. The optical axis is through
// the board's middle.
Scenario small_turn(double pivot_behind_mm) {
  auto scenario = *simulator::built_in("rig-0.1x");
  scenario.sensor.exposure_s = 1e-6;
  scenario.mount.pivot_z_mm = -pivot_behind_mm;
  scenario.camera.cx = 2051.5, scenario.camera.cy = 505.5;
  for (auto& marker : scenario.markers) marker.dx = marker.dy = {};
  return scenario;
}

// Places the references at (+-x, +-y), with one distance for circles and another for gratings.
void place_references(Scenario& scenario, double circle_x, double grating_x, double y) {
  for (auto& marker : scenario.markers) {
    if (marker.print.role != Role::kReference) continue;
    const auto& c = marker.print.circle->centre;
    const double sx = c.x < 0 ? -1 : 1, sy = c.y < 0 ? -1 : 1;
    marker.print.circle->centre = {sx * circle_x, sy * y};
    marker.print.grating->centre = {sx * grating_x, sy * y};
  }
}

double error_mm(const Scenario& scenario, test::Stages stages) {
  return std::abs(test::exact_error(scenario, scenario.frames - 1, 0, stages).y);
}

// Returns the shift of the board's middle in the image, in mm on the board.
double shift_mm(const Scenario& scenario) {
  const double px =
      project(scenario, scenario.frames - 1, BoardPoint{0, 0}).y - project(scenario, 0, BoardPoint{0, 0}).y;
  return px * scenario.mount.distance_mm / scenario.camera.fy;
}

double radial_error_mm(double k1, double shift_mm, double x_mm, double y_mm, double distance_mm) {
  return std::abs(k1 * shift_mm * (x_mm * x_mm + y_mm * y_mm) / (distance_mm * distance_mm));
}

// e = k s R^2 in four layouts, with the R of the circles, the target on the axis and a small rotation.
TEST(ClosedForms, CirclesAloneLeaveKSRSquaredOfTheCircles) {
  for (const auto& [x, y] : {std::pair{380.0, 28.0}, {150.0, 45.0}, {200.0, 100.0}, {100.0, 100.0}}) {
    auto scenario = small_turn(0.0);
    scenario.camera.k1 = test::kMinusOnePercent;
    place_references(scenario, x, 0.9 * x, y);
    const double expected =
        radial_error_mm(test::kMinusOnePercent, shift_mm(scenario), x, y, scenario.mount.distance_mm);
    EXPECT_NEAR(error_mm(scenario, test::Stages::kCirclesOnly) / expected, 1.0, 0.02) << x << " x " << y;
  }
}

// The second stage makes the gratings the fixed points, so R is theirs. One effect is neglected: a grating's
// displacement is added at its circle. Its relative size is (distance of the two) / R, in one direction per side, and
// cancels over the four.
TEST(ClosedForms, TheSecondStageLeavesKSRSquaredOfTheGratings) {
  for (const auto& [circle, grating] : {std::pair{380.0, 340.0}, {300.0, 340.0}, {200.0, 180.0}}) {
    auto scenario = small_turn(0.0);
    scenario.camera.k1 = test::kMinusOnePercent;
    place_references(scenario, circle, grating, 28.0);
    const double expected =
        radial_error_mm(test::kMinusOnePercent, shift_mm(scenario), grating, 28.0, scenario.mount.distance_mm);
    EXPECT_NEAR(error_mm(scenario, test::Stages::kBoth) / expected, 1.0, 0.02) << circle << ", " << grating;
  }
}

// A target dz behind the plane, and a camera centre that travels by t. The error is dz t / Z in mm of its own grating,
// for any rotation.
TEST(ClosedForms, ATargetOffThePlaneShiftsByTheCamerasTravel) {
  for (const double behind : {1.0, 10.0, 30.0, 100.0}) {
    for (const double pivot : {0.0, 100.0, 170.0}) {
      auto scenario = small_turn(pivot);
      for (auto& marker : scenario.markers) {
        if (marker.print.role == Role::kTarget) marker.place.z_mm = -behind;
      }
      const double travel = pivot * std::sin(0.1 * std::numbers::pi / 180.0);
      const double expected = behind * travel / scenario.mount.distance_mm;
      EXPECT_NEAR(error_mm(scenario, test::Stages::kBoth), expected, 0.01 * expected + 1e-7) << behind << ", " << pivot;
    }
  }
}

}  // namespace
}  // namespace moiregauge::internal
