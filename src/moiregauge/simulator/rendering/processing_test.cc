// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/simulator/rendering/processing.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "moiregauge/simulator/faults_for_tests.h"
#include "moiregauge/simulator/recorder.h"
#include "moiregauge/simulator/simulator.h"

namespace moiregauge::internal::simulator {
namespace {

TEST(ToneCurve, IsThatOfItsStandard) {
  // 18 % grey: IEC 61966-2-1 gives 0.46136, BT.709 0.40901.
  EXPECT_NEAR(encoded(*tone_named("srgb"), 0.18 * 255.0), 0.46136 * 255.0, 0.002);
  EXPECT_NEAR(encoded(*tone_named("bt709"), 0.18 * 255.0), 0.40901 * 255.0, 0.002);
  EXPECT_NEAR(encoded(*tone_named("gamma:2"), 0.25 * 255.0), 0.5 * 255.0, 1e-9);
  for (const char* name : {"linear", "srgb", "bt709", "gamma:2.2", "s-curve", "s-curve:1"}) {
    const ToneCurve tone = *tone_named(name);
    EXPECT_NEAR(encoded(tone, 0.0), 0.0, 1e-9) << name;
    EXPECT_NEAR(encoded(tone, 255.0), 255.0, 1e-9) << name;
    EXPECT_NEAR(encoded(tone, 300.0), 255.0, 1e-9) << name << ": what is over full is lost";
    for (double light = 0.0; light < 255.0; light += 0.5)
      EXPECT_LE(encoded(tone, light), encoded(tone, light + 0.5)) << name;
  }
  for (const char* wrong : {"", "log", "gamma", "gamma:0", "gamma:x", "s-curve:2", "srgb:2"})
    EXPECT_FALSE(tone_named(wrong)) << wrong;
}

Scenario quiet_lines() {
  Scenario scenario = lines(Pattern::kGrid);
  scenario.sensor.noise_sigma = 0.0;
  return scenario;
}

// Statistics of a corner of the background, in grey levels.
struct Patch {
  double mean = 0.0, scatter = 0.0;
};
Patch corner_of(const Image<std::uint8_t>& picture) {
  double sum = 0.0, squares = 0.0;
  int count = 0;
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 24; ++x, ++count) {
      sum += picture.at(x, y);
      squares += picture.at(x, y) * picture.at(x, y);
    }
  }
  const double mean = sum / count;
  return {mean, std::sqrt(squares / count - mean * mean)};
}
// A standard deviation from 480 pixels has a relative standard error of 3.2 %. The limit is 4 of these, plus the
// variance 1 / 12 of the rounding.
constexpr double kScatterTolerance = 0.15;

TEST(ToneCurve, StretchesTheNoiseOfTheDark) {
  Scenario scenario = lines(Pattern::kGrid);
  scenario.sensor.noise_sigma = 2.0;
  scenario.light.background = 30.0;
  scenario.processing.tone = *tone_named("gamma:2");
  const Patch patch = corner_of(render8(scenario, 0));
  const double slope = 0.5 * std::sqrt(255.0 / 30.0);
  EXPECT_NEAR(patch.scatter, 2.0 * slope, 2.0 * slope * kScatterTolerance);
}

// Returns an image of 50 grey levels left of column 20, and 200 from there.
Image<double> step_edge() {
  Image<double> picture(40, 24, 50.0);
  for (int y = 0; y < 24; ++y) {
    for (int x = 20; x < 40; ++x) picture.at(x, y) = 200.0;
  }
  return picture;
}
Image<double> developed(const Processing& processing, Image<double> picture) {
  DrawnParts parts(picture.width(), picture.height());
  parts.add(0, 0, picture.width(), picture.height());
  develop(processing, parts, picture);
  return picture;
}

TEST(Processing, SharpeningOvershootsByItsAmountAndIsClippedAtWhite) {
  // The edge is 0.5 px from the centre of the next pixel. A Gaussian of 4 px gives the other side a weight of
  // 1 - Phi(0.5 / 4), on a step of 150 grey levels.
  const double other_side = 150.0 * 0.5 * std::erfc(0.5 / 4.0 / std::sqrt(2.0));
  const auto picture = developed({.sharpen_amount = 0.3, .sharpen_radius_px = 4.0}, step_edge());
  EXPECT_NEAR(picture.at(19, 12), 50.0 - 0.3 * other_side, 0.5);
  EXPECT_NEAR(picture.at(20, 12), 200.0 + 0.3 * other_side, 0.5);
  const auto strong = developed({.sharpen_amount = 2.0, .sharpen_radius_px = 4.0}, step_edge());
  EXPECT_EQ(strong.at(20, 12), 255.0);
  EXPECT_EQ(strong.at(19, 12), 0.0);
}

TEST(Processing, ALowPassRingsByANinthOfAStep) {
  const auto picture = developed({.low_pass = 0.2}, step_edge());
  double highest = 0.0;
  for (int x = 20; x < 40; ++x) highest = std::max(highest, picture.at(x, 12));
  // The Gibbs overshoot is 8.9 % of the step; pixels miss the crest by a little.
  EXPECT_NEAR(highest, 200.0 + 0.08 * 150.0, 0.02 * 150.0);
}

TEST(Processing, SmoothingKeepsEdgesAndRemovesASinglePixel) {
  auto picture = step_edge();
  picture.at(8, 8) = 90.0;
  const auto by_median = developed({.median_px = 3}, picture);
  EXPECT_EQ(by_median.at(8, 8), 50.0);
  const auto by_weights = developed({.bilateral_px = 1.5, .bilateral_grey = 30.0}, picture);
  EXPECT_LT(by_weights.at(8, 8), 75.0);
  for (const auto* smooth : {&by_median, &by_weights}) {
    EXPECT_NEAR(smooth->at(19, 16), 50.0, 0.1);
    EXPECT_NEAR(smooth->at(20, 16), 200.0, 0.1);
  }
}

TEST(Processing, LargerPixelsShowTheMeanOfTheirArea) {
  const auto twice = developed({.pixel_size = 2.0}, step_edge());
  for (int x = 0; x < 40; x += 2) EXPECT_EQ(twice.at(x, 6), twice.at(x + 1, 6));
  Image<double> ramp(30, 8);
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 30; ++x) ramp.at(x, y) = 4.0 * x;
  }
  const auto coarse = developed({.pixel_size = 1.5}, ramp);
  // The block from 1.5 to 3 px contains half of pixel 1 and all of pixel 2.
  EXPECT_NEAR(coarse.at(2, 4), 4.0 * (0.5 * 1.0 + 2.0) / 1.5, 1e-9);
}

TEST(Processing, LocalToneMappingStretchesANarrowRangeUpToItsLargestSlope) {
  Image<double> soft(64, 64);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) soft.at(x, y) = 100.0 + 0.5 * x;
  }
  const auto picture = developed({.local_tone = {.strength = 1.0, .tile_px = 64, .most_slope = 3.0}}, soft);
  const double slope = (picture.at(60, 30) - picture.at(4, 30)) / (soft.at(60, 30) - soft.at(4, 30));
  EXPECT_GT(slope, 2.0);
  EXPECT_LT(slope, 4.0) << "the limit, and what was cut is given to all";
}

// Returns all spatial steps except local tone mapping, which depends on the whole image.
Processing everything() {
  Processing p;
  p.tone = *tone_named("srgb");
  p.median_px = 3;
  p.bilateral_px = 1.0;
  p.sharpen_amount = 0.5;
  p.low_pass = 0.4;
  p.pixel_size = 2.0;
  return p;
}

bool are_equal(const Picture& a, const Picture& b) {
  const auto &one = std::get<Image<std::uint8_t>>(a), &other = std::get<Image<std::uint8_t>>(b);
  for (int y = 0; y < one.height(); ++y) {
    if (!std::equal(one.row(y).begin(), one.row(y).end(), other.row(y).begin())) return false;
  }
  return true;
}

TEST(Processing, GivesTheSameBytesForAnyNumberOfThreads) {
  Scenario scenario = lines(Pattern::kGrid);
  scenario.processing = everything();
  scenario.processing.local_tone = {.strength = 0.5, .tile_px = 32};
  EXPECT_TRUE(are_equal(render(scenario, 0, {.threads = 1}), render(scenario, 0, {.threads = 3})));
}

TEST(Processing, OfTheMarkersAloneEqualsThatOfTheWholeImage) {
  Scenario scenario = quiet_lines();
  scenario.processing = everything();
  EXPECT_TRUE(are_equal(render(scenario, 0), render(scenario, 0, {.area = Area::kMarkersOnly})));
}

TEST(Recorder, AveragesReduceNoiseByTheRootOfTheirNumber) {
  Scenario scenario = lines(Pattern::kGrid);
  scenario.sensor.noise_sigma = 8.0;
  scenario.processing.average_frames = 4;
  const Patch patch = corner_of(render8(scenario, 5));
  EXPECT_NEAR(patch.scatter, 8.0 / 2.0, 4.0 * kScatterTolerance);
}

TEST(Recorder, RecursionReducesNoise) {
  Scenario scenario = lines(Pattern::kGrid);
  scenario.sensor.noise_sigma = 8.0;
  scenario.processing.recursion = 0.6;
  const Patch patch = corner_of(render8(scenario, 12));
  const double left = std::sqrt((1.0 - 0.6) / (1.0 + 0.6));
  EXPECT_NEAR(patch.scatter, 8.0 * left, 8.0 * left * kScatterTolerance);
}

TEST(Recorder, AnAdaptiveFilterDoesNotChangeMotion) {
  Scenario scenario = quiet_lines();
  scenario.markers[0].dy.knots = {{0.0, 0.0}, {0.1, 1.5}};
  const auto sharp = render(scenario, 1);
  scenario.processing.recursion = 0.5;
  EXPECT_FALSE(are_equal(render(scenario, 1), sharp));
  scenario.processing.motion_grey = 0.1;
  EXPECT_TRUE(are_equal(render(scenario, 1), sharp)) << "what changed is taken as it is";
}

TEST(Recorder, EqualsRenderInAnyOrderOfFrames) {
  Scenario scenario = lines(Pattern::kGrid);
  scenario.markers[0].dy.amplitude = 1.0;
  scenario.markers[0].dy.frequency_hz = 1.0;
  scenario.processing.average_frames = 3;
  scenario.processing.recursion = 0.3;
  Recorder recorder(scenario, {});
  for (const long frame : {2L, 3L, 5L, 1L}) EXPECT_TRUE(are_equal(recorder.frame(frame), render(scenario, frame)));
}

TEST(Focus, APointNearerThanTheFocusBecomesAGaussianOfHalfTheDiscRadius) {
  Scenario scenario = lines(Pattern::kLinesX);
  scenario.optics = {.focus_mm = 1260.0, .aperture_mm = 20.0};
  const double radius_px = 3478.26 * 10.0 * (1.0 / 1200.0 - 1.0 / 1260.0);
  ASSERT_GT(radius_px, 1.0);
  const auto blurred = render_ideal(scenario, 0);
  scenario.optics = {};
  scenario.sensor.psf_sigma_px = std::hypot(0.7, 0.5 * radius_px);
  const auto wide = render_ideal(scenario, 0);
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) EXPECT_NEAR(blurred.at(x, y), wide.at(x, y), 0.02);
  }
}

}  // namespace
}  // namespace moiregauge::internal::simulator
