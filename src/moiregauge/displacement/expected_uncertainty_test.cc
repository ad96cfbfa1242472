// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/expected_uncertainty.h"

#include <cmath>

#include <gtest/gtest.h>

#include "moiregauge/displacement/five_markers_for_tests.h"
#include "moiregauge/planning/codec_error.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

using test::five_markers, test::kA, test::kB, test::kMmPerPx, test::kPhase_rad, test::kPitch_mm;

TEST(ExpectedUncertainty, FourReferencesFollowTheClosedForm) {
  const auto expected = expected_uncertainties(five_markers(Pattern::kGrid), {});
  ASSERT_EQ(expected.size(), 1U);
  EXPECT_EQ(expected[0].marker, 4U);
  // Target and references have the noise s. Through the references u_x = (s/2) sqrt(1 + (a/b)^2) (reference_weights.h).
  // Both frames count.
  const auto since_reference_frame = [](double s) {
    return Extent<frame::Board>{s * std::sqrt(2.0 * (1.0 + 0.25 * (1.0 + kA * kA / (kB * kB)))),
                                s * std::sqrt(2.0 * (1.0 + 0.25 * (1.0 + kB * kB / (kA * kA))))};
  };
  const auto u = since_reference_frame(kPitch_mm / kTwoPi * kPhase_rad);
  EXPECT_NEAR(expected[0].u.x, u.x, 1e-9 * u.x);
  EXPECT_NEAR(expected[0].u.y, u.y, 1e-9 * u.y);
  // Bound: amplitude 60, noise 1.5, all 80 x 80 pixels of the grating.
  const auto bound = since_reference_frame(kPitch_mm / kTwoPi * (1.5 / 60.0) * std::sqrt(2.0 / (80.0 * 80.0)));
  EXPECT_NEAR(expected[0].bound.x, bound.x, 1e-9 * bound.x);
  EXPECT_NEAR(expected[0].bound.y, bound.y, 1e-9 * bound.y);
}

// In a predicted frame the target lags by its own share of the dead zone. No noise bound contains that.
TEST(ExpectedUncertainty, APredictiveCodecAddsTheLagThatMeasureStates) {
  const Reference reference = five_markers(Pattern::kGrid);
  const std::vector<Quantiser> later(5, {kUsualStep, true});
  const auto lossless = expected_uncertainties(reference, {}), lossy = expected_uncertainties(reference, later);
  const double slope = 60.0 * kTwoPi / (kPitch_mm / kMmPerPx) / std::sqrt(2.0);
  const double own = codec_u_px(later[4], Lag::kOwn, slope, 80.0 * 80.0) * kMmPerPx;
  EXPECT_GE(lossy[0].codec.y, own);
  EXPECT_LE(lossy[0].codec.y, 1.2 * own);  // references lag together: 0.2 / 0.55 of it, halved by four of them
  EXPECT_NEAR(lossy[0].u.y, std::hypot(lossless[0].u.y, lossy[0].codec.y), 1e-12);
  EXPECT_EQ(lossless[0].codec.y, 0.0);
  const std::vector<Quantiser> unknown(5, {kUnknownStep, true});  // then the usual step is assumed
  EXPECT_DOUBLE_EQ(expected_uncertainties(reference, unknown)[0].u.x, lossy[0].u.x);
}

TEST(ExpectedUncertainty, LinesShowNothingAlongThemselves) {
  const auto expected = expected_uncertainties(five_markers(Pattern::kLinesY), {});
  ASSERT_EQ(expected.size(), 1U);
  EXPECT_TRUE(std::isnan(expected[0].u.x));
  EXPECT_GT(expected[0].u.y, 0.0);
}

TEST(ExpectedUncertainty, ATargetThatIsNotSeenHasNoValue) {
  Reference reference = five_markers(Pattern::kGrid);
  reference.seen.markers[4].loss = Loss::kNoModulation;
  const auto expected = expected_uncertainties(reference, {});
  ASSERT_EQ(expected.size(), 1U);
  EXPECT_TRUE(std::isnan(expected[0].u.x) && std::isnan(expected[0].bound.y));
}

}  // namespace
}  // namespace moiregauge::internal
