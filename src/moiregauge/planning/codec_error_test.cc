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

// A grating of 48 x 48 px behind a codec that rounds each block on its own. It is at a different position in each of
// 100 frames.
constexpr int kRoundedBlocks = 6, kRoundedFrames = 100;
constexpr double kRoundedPixels = 64.0 * kRoundedBlocks * kRoundedBlocks, kRoundedHalf_px = 4.0 * kRoundedBlocks;
struct Rounded {
  double shift2 = 0.0, size2 = 0.0;      // mean squares of shift, px^2, and relative size along x
  double slope2 = 0.0, residual2 = 0.0;  // mean squares of the slope, and of the shift by independent residuals, px^2
  // u of the shift. That of `precise` contains the residual, too.
  [[nodiscard]] double u(double step) const {
    return std::hypot(codec_u_px({step, false}, Lag::kOwn, std::sqrt(slope2), kRoundedPixels), std::sqrt(residual2));
  }
};

// Reads shift and size by least squares: d = sum(e g) / sum(g^2).
Rounded rounded(double step) {
  constexpr double kPitch = 13.3, kAmplitude = 60.0, w = kTwoPi / kPitch;
  Rounded all;
  for (int frame = 0; frame < kRoundedFrames; ++frame) {
    double moved = 0.0, power = 0.0, left2 = 0.0, grown = 0.0, size_power = 0.0;
    for (int n = 0; n < kRoundedBlocks * kRoundedBlocks; ++n) {
      Block grey, slope, from_middle;
      for (int y = 0; y < 8; ++y) {
        for (int x = 0; x < 8; ++x) {
          const int column = 8 * (n % kRoundedBlocks) + x, row = 8 * (n / kRoundedBlocks) + y;
          const double px = column + 0.137 * frame, py = row + 0.071 * frame;
          grey(y, x) = 120.0 + kAmplitude * (std::cos(w * px) + 0.5 * std::cos(w * py));
          slope(y, x) = -kAmplitude * w * std::sin(w * px);
          from_middle(y, x) = column + 0.5 - kRoundedHalf_px;
        }
      }
      const Block error = rounding_error(grey, step), size = slope.cwiseProduct(from_middle);
      moved += error.cwiseProduct(slope).sum(), power += slope.squaredNorm(), left2 += error.squaredNorm();
      grown += error.cwiseProduct(size).sum(), size_power += size.squaredNorm();
    }
    all.shift2 += std::pow(moved / power, 2) / kRoundedFrames;
    all.size2 += std::pow(grown / size_power, 2) / kRoundedFrames;
    all.slope2 += power / kRoundedPixels / kRoundedFrames;
    all.residual2 += left2 / kRoundedPixels / power / kRoundedFrames;
  }
  return all;
}

// 100 frames show an rms to 7 %, so three standard deviations are 1.2.
TEST(CodecError, RoundingOfKeyFramesIsWithinU) {
  for (const double step : {6.0, 20.0, 40.0}) {
    const Rounded found = rounded(step);
    EXPECT_LT(std::sqrt(found.shift2), 1.2 * found.u(step)) << step;
    EXPECT_GT(std::sqrt(found.shift2), found.u(step) / 4.0) << step;
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

// Blocks are rounded independently, so the size is as uncertain as independent pixels make it. The middle of a square of
// half side H has the same lever as points at H / sqrt(2). A tenth is added to 1.2 as above: at the coarsest step, errors
// of neighbouring blocks are alike.
TEST(CodecError, RoundingChangesTheSizeAsMuchAsThePointsAllow) {
  BundleFrame frame;
  frame.points = {patch(10.0)};
  frame.points[0]->information *= 1e9, frame.points[0]->sigma /= std::sqrt(1e9);  // rounding alone
  Reference reference;
  reference.site.markers.resize(1), reference.seen.markers.resize(1);
  Observation seen;
  seen.markers.resize(1);
  seen.markers[0].quantiser = kAlone;
  const BundleFrame wide = with_codec_error(frame, CodecHistory(reference, {seen}), 0);
  const Eigen::Matrix<double, 9, 9> c = wide.points[0]->information.inverse().topLeftCorner<9, 9>();
  Eigen::Matrix<double, 9, 1> along;
  along << -1, 0, 1, -1, 0, 1, -1, 0, 1;
  const double size_to_shift = std::sqrt(along.dot(c * along) / 36.0) / std::sqrt(c.sum() / 81.0);
  for (const double step : {6.0, 20.0, 40.0}) {
    const Rounded found = rounded(step);
    const double size = std::sqrt(found.size2) * kRoundedHalf_px / std::sqrt(2.0);
    EXPECT_LT(size, 1.3 * size_to_shift * found.u(step)) << step;
    EXPECT_GT(size, size_to_shift * found.u(step) / 4.0) << step;
  }
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

// Lag is 10/9 because each point has it once of its own and once in common.
TEST(CodecError, TheMeanOfAReadingHasTheUncertaintyOfNoiseLagAndRounding) {
  BundleFrame frame;
  frame.points = {patch(10.0), patch(10.0)};
  const CodecHistory codec(reference_of_two(), observations({10.0, 10.0}));
  const BundleFrame wide = with_codec_error(frame, codec, 1);
  for (const std::size_t i : {0U, 1U}) {
    const auto [lag, rounding] = codec_parts_px({10.0, true}, codec.lag_of(i), 10.0, 10000.0);
    const PatchInformation c = wide.points[i]->information.inverse();
    const double mean = c.topLeftCorner<9, 9>().sum() / 81.0;
    EXPECT_NEAR(mean, 1e-4 / 9.0 + (lag * lag * 10.0 / 9.0 + rounding * rounding) / 400.0, 1e-12);
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
