// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/phase/fit/print_template.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "moiregauge/phase/fit/grating_for_tests.h"
#include "moiregauge/phase/fit/print_bins.h"

namespace moiregauge::internal {
namespace {

// Returns grey levels of light squares where bars cross, blurred by 0.757 px at a pitch of 29 px. Their mean is
// arbitrary.
double squares(PrintPoint p) {
  return 170.0 * testing::blurred_bars(29.0 * p.x, 29.0, 0.757) * testing::blurred_bars(29.0 * p.y, 29.0, 0.757);
}

TEST(PrintTemplate, LooksUpTheSeriesAndItsSlopes) {
  const auto print = PrintTemplate::cosine(40.0, 20.0);
  for (double x = -1.3; x < 1.3; x += 0.0917) {
    const double y = 0.7 - 0.9 * x;
    const PrintLevel level = print.at({x, y});
    EXPECT_NEAR(level.t, 40 * std::cos(kTwoPi * x) + 20 * std::cos(kTwoPi * y), 60 * 2e-5);
    EXPECT_NEAR(level.dx, -40 * kTwoPi * std::sin(kTwoPi * x), 40 * kTwoPi * 2e-3);
    EXPECT_NEAR(level.dy, -20 * kTwoPi * std::sin(kTwoPi * y), 20 * kTwoPi * 2e-3);
  }
  EXPECT_NEAR(print.slope_power_x(), 0.5 * std::pow(40 * kTwoPi, 2), 1e-9);
  EXPECT_NEAR(print.slope_power_y(), 0.5 * std::pow(20 * kTwoPi, 2), 1e-9);
}

// Pixels of an oblique image of a binary grating give its template. Harmonics beyond the order are small because of the
// blur.
TEST(PrintBins, LearnABlurredGratingFromAnObliqueImage) {
  PrintBins bins(highest_order(29.0));
  for (int y = -60; y <= 60; ++y) {
    for (int x = -60; x <= 60; ++x) {
      const PrintPoint p{(0.95 * x + 0.31 * y) / 29.0, (-0.29 * x + 0.96 * y) / 29.0};
      bins.add(p, squares(p));
    }
  }
  const auto series = bins.fit();
  ASSERT_TRUE(series);
  const PrintTemplate print(*series);
  double error = 0.0;
  for (double x = 0.0; x < 1.0; x += 0.037) {
    for (double y = 0.0; y < 1.0; y += 0.041) {
      // The mean of the grating is 170 / 4.
      error = std::max(error, std::abs(print.at({x, y}).t - (squares({x, y}) - 42.5)));
    }
  }
  // The 15th harmonic of the bars is 2 / (15 pi) exp(-(2 pi 15 x 0.757 / 29)^2 / 2) = 0.2 % of 170, both ways. The
  // bins' width of 1/104 pitch at slopes of 5 per pitch scatters the rest.
  EXPECT_LT(error, 1.5);
  EXPECT_NEAR(std::abs(print.coefficient(1, 0)), 0.5 * 170 / kPi * std::exp(-0.5 * std::pow(kTwoPi * 0.757 / 29, 2)),
              0.02);
  EXPECT_NEAR(std::abs(print.coefficient(2, 1)), 0.0, 0.05) << "half of it is dark: no even harmonics";
}

TEST(PrintBins, TooFewPixelsAreRefused) {
  PrintBins bins(3);
  for (int i = 0; i < 100; ++i) bins.add({0.01 * i, 0.07 * i}, 1.0);
  EXPECT_FALSE(bins.fit());
}

}  // namespace
}  // namespace moiregauge::internal
