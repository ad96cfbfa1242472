// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/print/movement_blur.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

constexpr unsigned kSeed = 20261128;

// Readings of ten gratings that move together. `own` and `common` are standard deviations of the variance, px^2.
std::vector<BlurReading> readings_of(double slope, double own, double common, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<BlurReading> readings;
  for (int n = 0; n < 40; ++n) {
    const double moved = 0.9 * std::sin(0.7 * n), shared = common * normal(random);
    for (std::size_t g = 0; g < 10; ++g)
      readings.push_back(
          {n, g, moved, 0.1 * static_cast<double>(g) + slope * moved * moved + shared + own * normal(random)});
  }
  return readings;
}

TEST(MovementBlur, TheSlopeOfAnAverageIsTheVarianceOfItsWeights) {
  for (const double slope : {0.0, 1.0 / 12.0, 2.0 / 3.0}) {
    const BlurSlope found = blur_slope(readings_of(slope, 0.05, 0.0, kSeed));
    EXPECT_NEAR(found.slope, slope, 4.0 * found.u) << "seed " << kSeed;
    // 400 values of 0.05 px^2; q has a standard deviation of 0.81 / sqrt(8) = 0.286 px^2. Few frames enlarge u by 1.1 to
    // 1.5.
    EXPECT_GT(found.u, 0.8 * 0.05 / std::sqrt(400.0) / 0.286);
    EXPECT_LT(found.u, 1.8 * 0.05 / std::sqrt(400.0) / 0.286);
  }
}

// Focus that changes from frame to frame blurs all gratings alike. As if they were independent, u would be a third.
TEST(MovementBlur, ABlurThatAllGratingsShareIsInU) {
  double squares = 0.0;
  constexpr int kRuns = 200;
  for (unsigned run = 0; run < kRuns; ++run) {
    const BlurSlope found = blur_slope(readings_of(0.0, 0.01, 0.05, kSeed + run));
    squares += std::pow(found.slope / found.u, 2) / kRuns;
  }
  // The mean square of 200 normal values scatters by 10 %. u is enlarged for few frames.
  EXPECT_LT(squares, 1.3) << "seed " << kSeed;
  EXPECT_GT(squares, 0.3);
}

TEST(MovementBlur, ASingleJumpShowsNothing) {
  std::vector<BlurReading> readings;
  for (int n = 0; n < 30; ++n) readings.push_back({n, 0, n == 12 ? 1.4 : 0.0, n == 12 ? 0.5 : 0.0});
  EXPECT_TRUE(std::isinf(blur_slope(readings).u));
  EXPECT_TRUE(std::isinf(blur_slope({}).u));
}

}  // namespace
}  // namespace moiregauge::internal
