// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numbers>

#include "moiregauge/phase/fit/grating_for_tests.h"
#include "moiregauge/phase/sampling_moire/sampling_moire.h"

namespace moiregauge::internal {
namespace {

using testing::crossed_binary;
using testing::crossed_cosine;
using testing::Grating;

constexpr std::uint64_t kMeanSeed = 20232;
constexpr Sampling kPaper{.sampling_pitch_px = 31.0, .pitch_px = 29.0, .region_px = 100};
constexpr Sampling kMatched{.sampling_pitch_px = 29.0, .pitch_px = 29.0, .region_px = 100};

using Print = Image<double> (*)(int, int, const Grating&);

RegionPhase measured(Print print, const Grating& grating, Axis axis, const Sampling& sampling) {
  const RegionPhase phase = measure_region(print(162, 162, grating).view(), axis, sampling);
  EXPECT_TRUE(phase.valid);
  return phase;
}

// Returns the displacement by Eq. (4), within half a pitch.
double displacement_px(const RegionPhase& before, const RegionPhase& after, double pitch_px) {
  return -pitch_px / kTwoPi * wrapped(after.phase_rad - before.phase_rad);
}

TEST(RegionMean, AGratingMovedTowardsLargerCoordinatesLosesPhase) {
  for (const double d : {-9.3, -0.01, 0.4, 12.0}) {
    // T = P: fringe and carrier are exact, so only rounding remains.
    const RegionPhase x = measured(crossed_cosine, {.shift_x_px = d}, Axis::kX, kMatched);
    const RegionPhase y = measured(crossed_cosine, {.shift_y_px = d}, Axis::kY, kMatched);
    EXPECT_NEAR(x.phase_rad, -kTwoPi * d / 29.0, 1e-12);
    EXPECT_NEAR(y.phase_rad, -kTwoPi * d / 29.0, 1e-12);
  }
}

TEST(RegionMean, AWholePitchIsInvisible) {
  const RegionPhase before = measured(crossed_cosine, {.shift_x_px = 1.7}, Axis::kX, kPaper);
  const RegionPhase after = measured(crossed_cosine, {.shift_x_px = 30.7}, Axis::kX, kPaper);
  EXPECT_NEAR(displacement_px(before, after, 29.0), 0.0, 1e-12);
}

TEST(RegionMean, LightingAloneNeverMovesTheGrating) {
  for (const Sampling& sampling : {kPaper, kMatched, Sampling{30.37, 29.0, 100}}) {
    const RegionPhase day = measured(crossed_cosine, {.shift_x_px = 3.1}, Axis::kX, sampling);
    const Grating dusk{.shift_x_px = 3.1, .amplitude = 11.0, .background = 33.0};
    const Grating glare{.shift_x_px = 3.1, .amplitude = 42.5, .background = 250.0};
    EXPECT_NEAR(displacement_px(day, measured(crossed_cosine, dusk, Axis::kX, sampling), 29.0), 0.0, 1e-12);
    EXPECT_NEAR(displacement_px(day, measured(crossed_cosine, glare, Axis::kX, sampling), 29.0), 0.0, 1e-12);
  }
}

TEST(RegionMean, MotionAlongXDoesNotMoveY) {
  const RegionPhase rest = measured(crossed_cosine, {}, Axis::kY, kPaper);
  const RegionPhase rest_binary = measured(crossed_binary, {}, Axis::kY, kMatched);
  for (const double d : {-11.0, 0.37, 5.0, 13.9}) {
    // Cosines add, and the crossed one has no fringe along y. Only rounding remains.
    EXPECT_NEAR(displacement_px(rest, measured(crossed_cosine, {.shift_x_px = d}, Axis::kY, kPaper), 29.0), 0.0, 1e-12);
    // The binary grating is a product. With T = P the mean across is over whole pitches, so the factors separate.
    const RegionPhase moved = measured(crossed_binary, {.shift_x_px = d}, Axis::kY, kMatched);
    EXPECT_NEAR(displacement_px(rest_binary, moved, 29.0), 0.0, 1e-12);
  }
}

// At 10 mm per 29 px, half a micrometre is 0.00145 px. The two differ in the mirror term (response 0.0011 for T = 31).
// On a binary grating the third harmonic adds to it. The region averages both.
TEST(RegionMean, SamplingPitch31Or29OnAPitchOf29DiffersByLessThanHalfAMicrometre) {
  for (const Print print : {&crossed_cosine, &crossed_binary}) {
    const RegionPhase rest_29 = measured(print, {}, Axis::kX, kMatched);
    const RegionPhase rest_31 = measured(print, {}, Axis::kX, kPaper);
    double worst = 0.0;
    for (int step = -10; step <= 10; ++step) {
      const Grating moved{.shift_x_px = 0.4 * step * 2.9, .shift_y_px = 1.3};
      const double by_29 = displacement_px(rest_29, measured(print, moved, Axis::kX, kMatched), 29.0);
      const double by_31 = displacement_px(rest_31, measured(print, moved, Axis::kX, kPaper), 29.0);
      worst = std::max(worst, std::abs(by_31 - by_29));
    }
    EXPECT_LT(worst, 0.00145);
    const bool binary = print == &crossed_binary;
    RecordProperty(binary ? "binary_um" : "cosine_um", std::to_string(worst / 29.0 * 1e4));
  }
}

TEST(RegionMean, ModulationDoesNotDependOnTheSamplingPitch) {
  // z| varies by the mirror term, at most 0.0041 for these T. Its mean over 3.4 pitches varies less.
  for (const double pitch : {27.0, 29.0, 30.5, 31.0}) {
    EXPECT_NEAR(measured(crossed_cosine, {}, Axis::kX, {pitch, 29.0, 100}).modulation / 42.5, 1.0, 0.0041);
  }
}

TEST(RegionMean, AWrongPitchBecomesAGradientAndKeepsThePhaseAtTheCentre) {
  // A pitch of 27 px is assumed to be 29 px. phi then gains 2 pi (1/27 - 1/29) per px, 1.6 rad over the region.
  const RegionPhase phase =
      measured(crossed_cosine, {.pitch_px = 27.0, .shift_x_px = 2.0}, Axis::kX, {27.0, 29.0, 100});
  EXPECT_NEAR(phase.gradient_x_rad_per_px, kTwoPi * (1.0 / 27.0 - 1.0 / 29.0), 1e-12);
  EXPECT_NEAR(phase.gradient_y_rad_per_px, 0.0, 1e-12);
  EXPECT_NEAR(phase.phase_rad, -kTwoPi * 2.0 / 27.0, 1e-11);
  EXPECT_LT(phase.straightness_rad, 1e-11);
  EXPECT_GT(std::abs(phase.gradient_x_rad_per_px) * 100.0, kPi / 2);
}

TEST(RegionMean, OnlyTheSupportOfTheRegionIsRead) {
  Image<double> picture = crossed_cosine(201, 190, {.shift_x_px = 3.0});
  const RegionPhase whole = region_mean(sampling_moire(picture.view(), Axis::kX, 31.0), Axis::kX, 29.0, 100);
  const RegionPhase part = measure_region(picture.view(), Axis::kX, kPaper);
  EXPECT_NEAR(whole.phase_rad, part.phase_rad, 1e-12);
  EXPECT_EQ(whole.centre_x_px, part.centre_x_px);
  EXPECT_EQ(whole.centre_y_px, part.centre_y_px);
  EXPECT_EQ(part.centre_x_px, 99.5);                  // an even region in an odd image: half a pixel off its centre
  for (double& value : picture.row(14)) value = 1e6;  // region + 2 (T - 1) = 160 rows: 15 to 174
  EXPECT_EQ(measure_region(picture.view(), Axis::kX, kPaper).phase_rad, part.phase_rad);
}

TEST(RegionMean, NothingIsMeasuredWhereTheGratingIsMissing) {
  const Image<double> blank(162, 162, 125.0);
  EXPECT_FALSE(measure_region(blank.view(), Axis::kX, kMatched).valid);
  Image<double> covered = crossed_cosine(162, 162, {});
  for (int y = 0; y < 162; ++y) {
    for (int x = 0; x < 81; ++x) covered.at(x, y) = 60.0;
  }
  EXPECT_FALSE(measure_region(covered.view(), Axis::kX, kMatched).valid);
  Image<double> unseen = crossed_cosine(162, 162, {});
  unseen.at(80, 80) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(measure_region(unseen.view(), Axis::kX, kMatched).valid);
  EXPECT_FALSE(measure_region(Image<double>(40, 40).view(), Axis::kX, kMatched).valid);
}

TEST(RegionMean, ADislocationOfTheFringeIsRefused) {
  FringeField field{Image<std::complex<double>>(40, 40), 6, 7.0};
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) {
      field.fringe.at(x, y) = std::polar(10.0, kTwoPi * x / 7.0 + std::atan2(y - 12.5, x - 9.5));
    }
  }
  EXPECT_FALSE(region_mean(field, Axis::kX, 7.0, 40).valid);
  EXPECT_TRUE(region_mean(field, Axis::kX, 7.0, 8).valid);  // pixels 16 to 23: the dislocation is outside
}

TEST(PhaseBound, IsRifeAndBoorstyns) {
  EXPECT_NEAR(phase_bound(1.5, 42.5, 1e4), 0.015 * std::numbers::sqrt2 / 42.5, 1e-15);
}

// The relative standard error of a scatter from n trials is 1 / sqrt(2 n). Four of them are allowed.
TEST(RegionMeanUncertainty, ScatterOverRepeatedNoiseMatchesTheStatedStandardUncertainty) {
  constexpr int kTrials = 4000;
  std::mt19937_64 rng(kMeanSeed);
  SCOPED_TRACE(::testing::Message() << "seed " << kMeanSeed);
  std::normal_distribution<double> noise(0.0, 1.5);
  for (const Sampling& sampling : {Sampling{9.0, 9.0, 20}, Sampling{10.0, 9.0, 20}, Sampling{9.5, 9.0, 20}}) {
    const Image<double> clean = crossed_cosine(40, 40, {.pitch_px = 9.0, .shift_x_px = 1.1});
    const double truth = measure_region(clean.view(), Axis::kX, sampling).phase_rad;
    double squares = 0.0;
    for (int trial = 0; trial < kTrials; ++trial) {
      Image<double> noisy = clean;
      for (int y = 0; y < 40; ++y) {
        for (double& value : noisy.row(y)) value += noise(rng);
      }
      squares += std::pow(measure_region(noisy.view(), Axis::kX, sampling).phase_rad - truth, 2);
    }
    const double stated = region_mean_uncertainty(1.5, 42.5, sampling.sampling_pitch_px, 9.0, 20);
    EXPECT_NEAR(std::sqrt(squares / kTrials) / stated, 1.0, 4.0 / std::sqrt(2.0 * kTrials))
        << "T = " << sampling.sampling_pitch_px;
  }
}

TEST(RegionMeanUncertainty, LiesBetweenTheBoundsOfTheSupportAndOfTheRegion) {
  const double u = region_mean_uncertainty(1.5, 42.5, 31.0, 29.0, 100);
  EXPECT_GT(u, phase_bound(1.5, 42.5, 160.0 * 160.0));
  EXPECT_LT(u, phase_bound(1.5, 42.5, 100.0 * 100.0));
  RecordProperty("of_region_bound", std::to_string(u / phase_bound(1.5, 42.5, 1e4)));
}

}  // namespace
}  // namespace moiregauge::internal
