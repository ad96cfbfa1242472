// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <complex>

#include <gtest/gtest.h>

#include "moiregauge/simulator/rendering/projection.h"
#include "moiregauge/simulator/simulator.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::simulator {
namespace {

constexpr double kPitch_mm = 10.0;

// Returns one grating and one circle, tilted by 40 degrees about an oblique axis, with strong lens distortion.
Scenario slanted(Pattern pattern) {
  Scenario scenario;
  scenario.camera = {.width = 240, .height = 200, .cx = 20.0, .cy = 30.0, .k1 = -0.37, .p1 = 0.01};
  scenario.mount.board_x_deg = 31.0;
  scenario.mount.board_y_deg = -27.0;
  scenario.mount.board_z_deg = 9.0;
  SceneMarker marker;
  marker.print.grating =
      Grating{.centre = {22.0, -18.0}, .width_mm = 40.0, .height_mm = 40.0, .pitch_mm = kPitch_mm, .pattern = pattern};
  marker.print.circle = Circle{{56.0, -18.0}, 16.0};
  scenario.markers.push_back(marker);
  return scenario;
}

bool is_line(double x) { return std::abs(x - kPitch_mm * std::round(x / kPitch_mm)) < 0.25 * kPitch_mm; }

// Returns the grey level of the sheet at a point, without the renderer.
double grey_at(const Scenario& scenario, BoardPoint p) {
  const SceneMarker& marker = scenario.markers[0];
  const Grating& grating = *marker.print.grating;
  if (length(p - marker.print.circle->centre) < 0.5 * marker.print.circle->diameter_mm) return scenario.light.black;
  const double x = p.x - grating.centre.x, y = p.y - grating.centre.y;
  if (std::abs(x) > 20.0 || std::abs(y) > 20.0) return scenario.light.white;
  bool is_dark = is_line(x) || is_line(y);
  if (grating.pattern == Pattern::kSquares) is_dark = is_line(x) && is_line(y);
  if (grating.pattern == Pattern::kCheckerboard) is_dark = is_line(x) == is_line(y);
  if (grating.pattern == Pattern::kDots) {
    const auto offset = [](double at) {
      return at - 10.0 * std::clamp(std::round(at / 10.0), -1.0, 1.0);
    };  // the pattern has whole dots only
    is_dark = std::hypot(offset(x), offset(y)) < 2.5;
  }
  return is_dark ? scenario.light.black : scenario.light.white;
}

BoardPoint board_point(const Scenario& scenario, ImagePoint pixel) {
  const Ray ray = ray_through(scenario.camera, pixel, {0.0, 0.0}).ray;
  const Vector3 w = product(inverse(camera_from_print(scenario, scenario.markers[0], 0.0)), Vector3{ray.x, ray.y, 1.0});
  return {w[0] / w[2], w[1] / w[2]};
}

// Integrates point spread and pixel area numerically on a fine grid.
double brute_force(const Scenario& scenario, int px, int py) {
  constexpr int kPerPixel = 40, kReach = 4 * kPerPixel;
  const double root = scenario.sensor.psf_sigma_px * std::sqrt(2.0);
  const auto weight = [&](double d) { return std::erf((d + 0.5) / root) - std::erf((d - 0.5) / root); };
  double sum = 0.0, weights = 0.0;
  for (int j = -kReach; j <= kReach; ++j) {
    for (int i = -kReach; i <= kReach; ++i) {
      const double u = (i + 0.31) / kPerPixel, v = (j + 0.17) / kPerPixel, w = weight(u) * weight(v);
      sum += w * grey_at(scenario, board_point(scenario, {px + u, py + v}));
      weights += w;
    }
  }
  return sum / weights;
}

class EveryPrint : public testing::TestWithParam<Pattern> {};

TEST_P(EveryPrint, IsTheMeanOfTheLightOverPointSpreadAndPixel) {
  const Scenario scenario = slanted(GetParam());
  const Image<double> picture = render_ideal(scenario, 0);
  const ImagePoint middle = project(scenario, 0, scenario.markers[0], {22.0, -18.0});
  double worst = 0.0;
  for (int i = 0; i < 20; ++i) {
    const int x = static_cast<int>(middle.x) - 40 + 6 * i, y = static_cast<int>(middle.y) - 30 + (17 * i) % 61;
    worst = std::max(worst, std::abs(picture.at(x, y) - brute_force(scenario, x, y)));
  }
  // The grid has an error of some 0.01 grey levels. The renderer draws dots to the first order of their curvature.
  EXPECT_LT(worst, GetParam() == Pattern::kDots ? 0.5 : 0.1);
}

INSTANTIATE_TEST_SUITE_P(Patterns, EveryPrint,
                         testing::Values(Pattern::kGrid, Pattern::kSquares, Pattern::kCheckerboard, Pattern::kDots));

// Returns the phase of the first harmonic along x and y in px, under a smooth window in board coordinates.
std::complex<double> phase_px(const Scenario& scenario, const Image<double>& picture) {
  const BoardPoint centre = scenario.markers[0].print.grating->centre;
  std::complex<double> along_x, along_y;
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      const auto at = [&](double u, double v) { return board_point(scenario, {x + u, y + v}); };
      const auto d = at(0, 0) - centre;
      if (std::abs(d.x) > 15.0 || std::abs(d.y) > 15.0) continue;
      const auto du = at(0.5, 0) - at(-0.5, 0), dv = at(0, 0.5) - at(0, -0.5);
      const double window = std::pow(std::cos(d.x * kPi / 30.0) * std::cos(d.y * kPi / 30.0), 4);
      const double weight = window * std::abs(du.x * dv.y - du.y * dv.x) * (picture.at(x, y) - 125.0);
      along_x += weight * std::polar(1.0, -kTwoPi * d.x / kPitch_mm);
      along_y += weight * std::polar(1.0, -kTwoPi * d.y / kPitch_mm);
    }
  }
  const double pitch_px = 29.0, sign = scenario.markers[0].print.grating->pattern == Pattern::kCosine ? 1.0 : -1.0;
  return {std::arg(sign * along_x) / kTwoPi * pitch_px, std::arg(sign * along_y) / kTwoPi * pitch_px};
}

class EveryPhase : public testing::TestWithParam<Pattern> {};

TEST_P(EveryPhase, IsZeroAtTheSymmetryPointAtAnyTilt) {
  const Scenario scenario = slanted(GetParam());
  const auto error = phase_px(scenario, render_ideal(scenario, 0));
  EXPECT_NEAR(error.real(), 0.0, 5e-4);
  EXPECT_NEAR(error.imag(), 0.0, 5e-4);
}

INSTANTIATE_TEST_SUITE_P(Patterns, EveryPhase, testing::Values(Pattern::kGrid, Pattern::kCosine, Pattern::kSquares));

TEST(Rendering, TheLensIsInvertedExactly) {
  const Scenario scenario = slanted(Pattern::kGrid);
  const ImagePoint there = project(scenario, 0, scenario.markers[0], {31.0, -7.0});
  const BoardPoint back = board_point(scenario, there);
  EXPECT_NEAR(back.x, 31.0, 1e-9);
  EXPECT_NEAR(back.y, -7.0, 1e-9);
}

}  // namespace
}  // namespace moiregauge::internal::simulator
