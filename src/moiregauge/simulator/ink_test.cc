// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "moiregauge/simulator/faults_for_tests.h"
#include "moiregauge/simulator/rendering/texture.h"

namespace moiregauge::internal::simulator {
namespace {

// Statistics of an image without noise, in grey levels.
struct Greys {
  double mean = 0.0, rms = 0.0;
};
Greys greys_in(const Image<double>& picture, int left, int top, int width, int height) {
  double sum = 0.0, squares = 0.0;
  for (int y = top; y < top + height; ++y) {
    for (int x = left; x < left + width; ++x) {
      sum += picture.at(x, y);
      squares += picture.at(x, y) * picture.at(x, y);
    }
  }
  const double n = static_cast<double>(width) * height;
  return {sum / n, std::sqrt(std::max(squares / n - sum / n * sum / n, 0.0))};
}

// Returns a grating with a pitch of 20 px, so that windows hold whole periods.
Scenario ink_lines(Pattern pattern) {
  Scenario scenario = lines(pattern);
  scenario.camera.fx = scenario.camera.fy = 20.0 / kPitch_mm * scenario.mount.distance_mm;
  return scenario;
}

TEST(Ink, LinesTakeTheirShareOfThePitchAndDotGainWidensThem) {
  Scenario scenario = ink_lines(Pattern::kLinesX);
  Ink& ink = scenario.markers[0].ink;
  const double white = scenario.light.white, contrast = white - scenario.light.black;
  ink.line_share = 0.16;
  // The tolerance of 2e-3 of the contrast is for windows that do not begin at a period.
  EXPECT_NEAR(greys_in(render_ideal(scenario, 0), 60, 50, 40, 20).mean, white - 0.16 * contrast, 2e-3 * contrast);
  ink.gain_mm = 0.15;
  EXPECT_NEAR(greys_in(render_ideal(scenario, 0), 60, 50, 40, 20).mean, white - 0.21 * contrast, 2e-3 * contrast);
  scenario.markers[0].print.grating->pattern = Pattern::kGrid;
  EXPECT_NEAR(greys_in(render_ideal(scenario, 0), 60, 50, 40, 20).mean, white - (1.0 - 0.79 * 0.79) * contrast,
              2e-3 * contrast);
}

TEST(Ink, RaggedEdgesAndUnevenInkMoveWithThePrint) {
  Scenario scenario = ink_lines(Pattern::kGrid);
  scenario.markers[0].ink = {.line_share = 0.2, .rough_mm = 0.15, .mottle = 0.2, .grain = 4.0};
  const auto before = render_ideal(scenario, 0);
  scenario.markers[0].dx.offset = 2.0 / px_per_mm(scenario);
  const auto after = render_ideal(scenario, 0);
  double roughness = 0.0;
  for (int y = 42; y < 70; ++y) {
    for (int x = 55; x < 100; ++x) {
      EXPECT_NEAR(after.at(x + 2, y), before.at(x, y), 1e-3);
      roughness = std::max(roughness, std::abs(before.at(x, y) - before.at(x, y + 20)));
    }
  }
  EXPECT_GT(roughness, 20.0) << "no two pitches are alike";
}

TEST(Ink, EdgesDeviateByTheirRoughness) {
  // The deviation of an edge in each column is the change of its grey level divided by the slope.
  Scenario scenario = ink_lines(Pattern::kLinesY);
  const auto straight = render_ideal(scenario, 0);
  Ink& ink = scenario.markers[0].ink;
  ink.rough_mm = 0.06;
  ink.rough_length_mm = 1.2;
  const auto ragged = render_ideal(scenario, 0);
  double squares = 0.0;
  int count = 0;
  for (int y = 42; y < 78; ++y) {
    const double slope = 0.5 * (straight.at(80, y + 1) - straight.at(80, y - 1));
    if (std::abs(slope) < 30.0) continue;
    for (int x = 45; x < 115; ++x, ++count) squares += std::pow((ragged.at(x, y) - straight.at(x, y)) / slope, 2);
  }
  // 70 px hold about 17 grains per line, on five or six lines. The relative standard error is 0.1; the limit is 3 of
  // it.
  EXPECT_NEAR(std::sqrt(squares / count), 0.06 * px_per_mm(scenario), 0.3 * 0.06 * px_per_mm(scenario));
}

TEST(Ink, GrainHasTheRmsItStates) {
  double sum = 0.0, squares = 0.0;
  constexpr int kSide = 400;
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) {
      const double value = grain(7, 0.317 * i, 0.317 * j);
      sum += value;
      squares += value * value;
    }
  }
  constexpr double kCount = kSide * kSide;
  // For 127 x 127 grains the standard error is 0.8 % for the mean and half of that for the rms. The limit is 4 of
  // these.
  EXPECT_NEAR(sum / kCount, 0.0, 0.032);
  EXPECT_NEAR(std::sqrt(squares / kCount), 1.0, 0.02);
}

}  // namespace
}  // namespace moiregauge::internal::simulator
