// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/planning/codec_error.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr Quantiser kPredicted{10.0, true}, kAlone{10.0, false};
constexpr double kArea = 100.0 * 100.0;

TEST(CodecError, LosslessCodecsAddNothing) {
  EXPECT_EQ(codec_u_px({0.0, true}, Lag::kOwn, 10.0, kArea), 0.0);
  EXPECT_EQ(codec_u_px(kPredicted, Lag::kOwn, 0.0, kArea), 0.0);  // an axis that the grating does not show
}

TEST(CodecError, TheDeadZoneIsProportionalToStepOverSlope) {
  const double u = codec_u_px({1.0, true}, Lag::kOwn, 20.0, kArea);  // far below the limit of 0.12 px
  EXPECT_NEAR(codec_u_px({2.0, true}, Lag::kOwn, 20.0, kArea) / u, 2.0, 0.01);
  EXPECT_NEAR(codec_u_px({2.0, true}, Lag::kOwn, 40.0, kArea) / u, 1.0, 1e-12);
}

TEST(CodecError, MotionVectorsLimitTheErrorOfAFaintGrating) {
  const double faint = codec_u_px({40.0, true}, Lag::kOwn, 0.5, 1e9);
  EXPECT_LT(faint, 0.125);  // px: half of a quarter
  EXPECT_GT(faint, 0.125 / std::sqrt(3.0));
}

TEST(CodecError, RoundingAveragesOutOverTheGratingButLagDoesNot) {
  EXPECT_NEAR(codec_u_px(kPredicted, Lag::kOwn, 10.0, 1e4) / codec_u_px(kPredicted, Lag::kOwn, 10.0, 1e8), 1.0, 0.05);
  EXPECT_NEAR(codec_u_px(kAlone, Lag::kOwn, 10.0, 1e4) / codec_u_px(kAlone, Lag::kOwn, 10.0, 1e6), 10.0, 1e-9);
}

// Rounds the coefficients of an 8 x 8 block to whole steps, as a key frame does. Returns the change of its pixels.
using Block = Eigen::Matrix<double, 8, 8>;
Block rounding_error(const Block& grey, double step) {
  Block cosine;
  for (int k = 0; k < 8; ++k) {
    for (int x = 0; x < 8; ++x)
      cosine(k, x) = std::sqrt(k == 0 ? 0.125 : 0.25) * std::cos(std::numbers::pi * (x + 0.5) * k / 8.0);
  }
  const Block coefficients = cosine * grey * cosine.transpose();
  const Block rounded = (coefficients / step).array().round().matrix() * step;
  return cosine.transpose() * (rounded - coefficients) * cosine;
}

// The grating is at a different position in each of 100 frames. Least squares reads it: d = sum(e g) / sum(g^2). u of
// `precise` contains the residual, too. 100 frames show an rms to 7 %, so three standard deviations are 1.2.
TEST(CodecError, RoundingOfKeyFramesIsWithinU) {
  constexpr double kPitch = 13.3, kAmplitude = 60.0;
  constexpr int kBlocks = 6;
  constexpr double kPixels = 64.0 * kBlocks * kBlocks;
  for (const double step : {6.0, 20.0, 40.0}) {
    double squares = 0.0, slope2 = 0.0, residual2 = 0.0;
    for (int frame = 0; frame < 100; ++frame) {
      double moved = 0.0, power = 0.0, left2 = 0.0;
      for (int n = 0; n < kBlocks * kBlocks; ++n) {
        Block grey, slope;
        for (int y = 0; y < 8; ++y) {
          for (int x = 0; x < 8; ++x) {
            const double px = 8 * (n % kBlocks) + x + 0.137 * frame, py = 8 * (n / kBlocks) + y + 0.071 * frame;
            const double w = kTwoPi / kPitch;
            grey(y, x) = 120.0 + kAmplitude * (std::cos(w * px) + 0.5 * std::cos(w * py));
            slope(y, x) = -kAmplitude * w * std::sin(w * px);
          }
        }
        const Block error = rounding_error(grey, step);
        moved += error.cwiseProduct(slope).sum(), power += slope.squaredNorm(), left2 += error.squaredNorm();
      }
      squares += std::pow(moved / power, 2) / 100.0, slope2 += power / kPixels / 100.0;
      residual2 += left2 / kPixels / power / 100.0;
    }
    const double u = std::hypot(codec_u_px({step, false}, Lag::kOwn, std::sqrt(slope2), kPixels), std::sqrt(residual2));
    EXPECT_LT(std::sqrt(squares), 1.2 * u) << step;
    EXPECT_GT(std::sqrt(squares), u / 4.0) << step;
  }
}

// A reading whose nine points are known to 0.01 pitch each, with 20 px per pitch.
PatchFit patch(double slope_per_px) {
  PatchFit fit;
  for (int k = 0; k < kPatchPoints; ++k) {
    const double x = 2.0 * (k % 3 - 1), y = 2.0 * (k / 3 - 1);
    fit.print[static_cast<std::size_t>(k)] = {x, y};
    fit.image[static_cast<std::size_t>(k)] = {500.0 + 20.0 * x, 300.0 - 20.0 * y};
  }
  fit.pixels = 10000;
  fit.information = PatchInformation::Identity() * 1e4;
  // sigma^2 times the sum of the information along an axis is the energy of the slopes per pitch^2.
  fit.sigma = std::sqrt(fit.pixels * std::pow(slope_per_px * 20.0, 2) / (9.0 * 1e4));
  return fit;
}

Reference reference_of_two() {
  Reference reference;
  reference.site.markers.resize(2);
  reference.site.markers[1].role = Role::kTarget;
  reference.seen.markers.resize(2);
  return reference;
}

Observations observations(const std::vector<double>& steps) {
  Observations all;
  for (const double step : steps) {
    Observation seen;
    seen.frame = static_cast<long>(all.size());
    seen.markers.resize(2);
    for (MarkerObservation& marker : seen.markers) marker.quantiser = {step, true};
    all.push_back(seen);
  }
  return all;
}

TEST(CodecError, TheMeanOfAReadingHasTheUncertaintyOfNoiseAndLag) {
  BundleFrame frame;
  frame.points = {patch(10.0), patch(10.0)};
  const CodecHistory codec(reference_of_two(), observations({10.0, 10.0}));
  const BundleFrame wide = with_codec_error(frame, codec, 1);
  for (const std::size_t i : {0U, 1U}) {
    const double u = codec_u_px({10.0, true}, codec.lag_of(i), 10.0, 10000.0) / 20.0;
    const PatchInformation c = wide.points[i]->information.inverse();
    const double mean = c.topLeftCorner<9, 9>().sum() / 81.0;
    EXPECT_NEAR(mean, 1e-4 / 9.0 + u * u * (1.0 + 1.0 / 9.0), 1e-9);
    EXPECT_NEAR((c.topRightCorner<9, 9>().norm()), 0.0, 1e-12);
  }
  EXPECT_GT(wide.points[0]->information.trace(),
            wide.points[1]->information.trace());  // a reference lags with the others
}

TEST(CodecError, AFollowingFrameHasTheErrorOfAFrameWithin) {
  BundleFrame frame;
  frame.points = {patch(10.0), patch(10.0)};
  const auto reference = reference_of_two();
  const auto all = observations({10.0, 10.0, 10.0});
  const CodecHistory codec(reference, all);
  const BundleFrame within = with_codec_error(frame, codec, 2);
  const BundleFrame next = with_codec_error(frame, codec, codec.of_next(reference, all.back()));
  for (const std::size_t i : {0U, 1U}) EXPECT_EQ(next.points[i]->information, within.points[i]->information) << i;
  EXPECT_LT(next.points[1]->information.trace(), frame.points[1]->information.trace());
}

TEST(CodecError, LosslessFootageKeepsItsBits) {
  BundleFrame frame;
  frame.points = {patch(10.0), patch(3.0)};
  const CodecHistory codec(reference_of_two(), observations({0.0, 0.0}));
  EXPECT_FALSE(codec.is_lossy());
  EXPECT_EQ(with_codec_error(frame, codec, 1).points[1]->information, frame.points[1]->information);
}

TEST(CodecHistory, ASkippedFrameHasTheLargestStepNearby) {
  const CodecHistory codec(reference_of_two(), observations({14.0, 2.0, 2.0, 20.0, 2.0, 2.0}));
  for (std::size_t n = 0; n < 6; ++n) EXPECT_EQ(codec.at(n, 1).step, 20.0) << n;
}

TEST(CodecHistory, OneCoarseFrameDoesNotAffectALongRun) {
  std::vector<double> steps(200, 8.0);
  steps[100] = 80.0;
  const CodecHistory codec(reference_of_two(), observations(steps));
  EXPECT_EQ(codec.at(50, 1).step, 8.0);
  EXPECT_EQ(codec.at(110, 1).step, 80.0);
}

TEST(CodecHistory, ASkippedNextFrameHasTheLargestStepShortlyBeforeIt) {
  const auto reference = reference_of_two();
  const CodecHistory codec(reference, observations({2.0, 20.0, 2.0}));
  EXPECT_EQ(codec.of_next(reference, observations({2.0}).front())[1].step, 20.0);
  EXPECT_EQ(codec.of_next(reference, observations({30.0}).front())[1].step, 30.0);
}

TEST(CodecHistory, ALosslessNextFrameStaysLossless) {
  const auto reference = reference_of_two();
  const auto all = observations({0.0, 0.0});
  EXPECT_TRUE(CodecHistory(reference, all).of_next(reference, all.back())[1].is_lossless());
}

TEST(CodecHistory, AnUnknownStepCountsAsAUsualOne) {
  const CodecHistory codec(reference_of_two(), observations({kUnknownStep, kUnknownStep}));
  EXPECT_TRUE(codec.is_lossy());
  EXPECT_NEAR(codec.at(1, 0).step, step_of_parameter(28), 0.05);
}

}  // namespace
}  // namespace moiregauge::internal
