// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/phase/fit/tone_evidence.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "moiregauge/phase/fit/grating_for_tests.h"
#include "moiregauge/phase/fit/template_for_tests.h"

namespace moiregauge::internal {
namespace {

constexpr double kBlack = 0.12, kWhite = 0.8, kPitchPx = 20.0;
constexpr int kOrder = 9;  // pitch / 2.2 px

double grid_light(double x, double y) {
  const double bars =
      testing::blurred_bars(x * kPitchPx, kPitchPx, 0.757) * testing::blurred_bars(y * kPitchPx, kPitchPx, 0.757);
  return kBlack + (kWhite - kBlack) * bars;
}

double dot_light(double x, double y) {
  const double r = std::hypot(x - 0.5, y - 0.5) - 0.25;
  return kWhite - 0.5 * (kWhite - kBlack) * std::erfc(r * kPitchPx / 0.757 / std::sqrt(2.0));
}

template <typename Light>
std::optional<ToneExponent> shown_by(const Light& light, double gamma) {
  double mean = 0.0;
  for (int k = 0; k < 64 * 64; ++k)
    mean += std::pow(light((k % 64) / 64.0, (k / 64) / 64.0), 1.0 / gamma) / (64.0 * 64.0);
  const auto print =
      testing::template_of(kOrder, [&](double x, double y) { return 255.0 * std::pow(light(x, y), 1.0 / gamma); });
  const std::array samples{ToneSample{&print, mean, 1.0 / 255.0}, ToneSample{&print, mean, 1.0 / 255.0}};
  return edge_exponent(samples, ToneCurve{});
}

// A template in grey levels lacks the highest harmonics of an edge that a tone curve sharpens. It therefore shows only
// a part of the curve, and the power is found in rounds. The rounds must end at 1 for a template of light.
TEST(ToneEvidence, EdgesOfAGridInLightShowNoCurve) {
  const auto shown = shown_by(grid_light, 1.0);
  ASSERT_TRUE(shown);
  EXPECT_NEAR(shown->value, 1.0, 0.03);
  EXPECT_EQ(shown->edges, 4);
}

TEST(ToneEvidence, EdgesBehindACurveShowAGoodPartOfIt) {
  for (const double gamma : {1.4, 1.8, 2.2, 2.6}) {
    const auto shown = shown_by(grid_light, gamma);
    ASSERT_TRUE(shown) << gamma;
    EXPECT_GT(std::log(shown->value), 0.4 * std::log(gamma)) << gamma;
    EXPECT_LT(std::log(shown->value), 1.1 * std::log(gamma)) << gamma;
  }
}

// Blurred by a quarter of the pitch, lines have no flat black and white. A sine of any power shows no curve.
TEST(ToneEvidence, LinesTooThinForTheBlurShowNone) {
  const auto thin_light = [](double x, double) {
    return kBlack + (kWhite - kBlack) * testing::blurred_bars(x * kPitchPx, kPitchPx, 5.0);
  };
  EXPECT_FALSE(shown_by(thin_light, 1.0));
  EXPECT_FALSE(shown_by(thin_light, 2.2));
}

// The curved edge of a dot is not symmetric in light, either.
TEST(ToneEvidence, DotsShowNone) { EXPECT_FALSE(shown_by(dot_light, 2.2)); }

}  // namespace
}  // namespace moiregauge::internal
