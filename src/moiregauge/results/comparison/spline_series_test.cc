// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/comparison/spline_series.h"

#include <cmath>

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

Series sine(double step_s) {
  Series series;
  for (int n = 0; n <= 100; ++n) {
    series.time_s.push_back(step_s * n);
    series.value.push_back(std::sin(series.time_s.back()));
  }
  return series;
}

TEST(SplineSeries, ASineIsInterpolatedToTheFourthPowerOfTheStep) {
  for (const double step : {0.1, 0.05}) {
    const Series series = sine(step);
    const SplineSeries spline(series);
    double worst = 0.0, worst_slope = 0.0;
    for (double t = 1.0; t < 100 * step - 1.0; t += 0.013) {  // 10 samples from the ends, whose curvature is set to 0
      worst = std::max(worst, std::abs(spline.at(t).value - std::sin(t)));
      worst_slope = std::max(worst_slope, std::abs(spline.at(t).slope - std::cos(t)));
    }
    EXPECT_LT(worst, 1.5 * std::pow(step, 4.0) / 384.0 + 1e-7);
    EXPECT_LT(worst_slope, std::pow(step, 3.0) / 20.0);
  }
}

TEST(SplineSeries, SamplesAreKept) {
  const Series series = sine(0.3);
  const SplineSeries spline(series);
  for (std::size_t i = 0; i < series.time_s.size(); ++i)
    EXPECT_NEAR(spline.at(series.time_s[i]).value, series.value[i], 1e-14);
}

TEST(SplineSeries, AGapHasNoValue) {
  Series series = sine(0.1);
  series.value[50] = series.value[51] = kNotMeasured;  // three steps without a value
  series.value[20] = kNotMeasured;                     // two steps
  const SplineSeries spline(series);
  EXPECT_TRUE(std::isnan(spline.at(5.05).value));
  EXPECT_NEAR(spline.at(2.0).value, std::sin(2.0), 1e-4);
  EXPECT_TRUE(std::isnan(spline.at(-0.01).value));
  EXPECT_TRUE(std::isnan(spline.at(10.01).value));
}

}  // namespace
}  // namespace moiregauge::internal
