// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/rolling_shutter/smooth_path.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr double kFps = 30.0, kPathNoise = 1e-4;

struct Sampled {
  std::vector<double> time, value, variance, rate;
};

Sampled sine(double frequency_hz, int count, double noise) {
  std::mt19937_64 rng(3);
  std::normal_distribution<double> normal(0.0, noise);
  Sampled out;
  for (int i = 0; i < count; ++i) {
    const double t = i / kFps, phase = kTwoPi * frequency_hz * t + 0.4;
    out.time.push_back(t);
    out.value.push_back(std::sin(phase) + normal(rng));
    out.variance.push_back(noise * noise);
    out.rate.push_back(kTwoPi * frequency_hz * std::cos(phase));
  }
  return out;
}

// Excludes both ends, where a spline has neighbours on one side only.
double rms_of_rate(const Sampled& s, const std::vector<PathPoint>& path) {
  constexpr std::size_t kEnd = 8;
  double sum = 0.0;
  for (std::size_t i = kEnd; i + kEnd < path.size(); ++i) sum += std::pow(path[i].rate - s.rate[i], 2);
  return std::sqrt(sum / static_cast<double>(path.size() - 2 * kEnd));
}

// For a straight line the model does not matter: the rate is exact to noise * sqrt(12 / n) / duration.
TEST(SmoothPath, IsExactForAStraightLine) {
  Sampled line = sine(0.0, 31, kPathNoise);
  for (std::size_t i = 0; i < line.time.size(); ++i) line.value[i] += 2.0 * line.time[i];
  for (const PathPoint& p : smooth_path(line.time, line.value, line.variance)) {
    EXPECT_NEAR(p.rate, 2.0, 5.0 * std::sqrt(p.covariance(0, 0)) + 20.0 * kPathNoise * std::sqrt(12.0 / 31.0));
  }
}

// Relative errors of the rate at a quarter of the sample rate, with x = pi / 2. Central differences: 36 % (sin x / x).
// Cubic spline: 4.5 % (3 sin x / (2 + cos x) / x), and 4.7 % with noise.
TEST(SmoothPath, FollowsASineAtAQuarterOfTheSampleRate) {
  const Sampled s = sine(0.25 * kFps, 60, kPathNoise);
  const auto path = smooth_path(s.time, s.value, s.variance);
  EXPECT_LT(rms_of_rate(s, path), 0.047 * kTwoPi * 0.25 * kFps / std::sqrt(2.0));
}

// The error is within 4 u at all 60 samples.
TEST(SmoothPath, ErrorsOfTheRateAreWithinFourU) {
  for (const double frequency : {0.5, 3.0, 7.5, 11.0}) {
    const Sampled s = sine(frequency, 60, kPathNoise);
    const auto path = smooth_path(s.time, s.value, s.variance);
    for (std::size_t i = 0; i < path.size(); ++i)
      EXPECT_LT(std::abs(path[i].rate - s.rate[i]), 4.0 * std::sqrt(path[i].covariance(0, 0)))
          << frequency << " Hz, " << i;
  }
}

// Above half the sample rate a sine looks slow. Only the points within a frame show such motion.
TEST(SmoothPath, AVibrationAboveHalfTheSampleRateLooksSlow) {
  const Sampled s = sine(29.0, 60, kPathNoise);
  const auto path = smooth_path(s.time, s.value, s.variance);
  for (const PathPoint& p : path) EXPECT_LT(std::abs(p.rate), 0.1 * kTwoPi * 29.0);
}

TEST(SmoothPath, OneSampleGivesNoRate) {
  const std::vector<double> one{1.0};
  const auto path = smooth_path(one, one, one);
  ASSERT_EQ(path.size(), 1U);
  EXPECT_EQ(path[0].rate, 0.0);
}

}  // namespace
}  // namespace moiregauge::internal
