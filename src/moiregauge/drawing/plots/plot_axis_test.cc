// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/drawing/plots/plot_axis.h"

#include <cmath>

#include <gtest/gtest.h>

namespace moiregauge::internal::figure {
namespace {

std::vector<std::string> labels_of(const std::vector<Tick>& ticks) {
  std::vector<std::string> labels;
  for (const Tick& tick : ticks) {
    if (!tick.label.empty()) labels.push_back(tick.label);
  }
  return labels;
}

TEST(DecadeTicks, ArePowersOfTenAndCoverTheRange) {
  const auto ticks = decade_ticks({0.0004, 6.2}, 9);
  ASSERT_EQ(ticks.size(), 6U);
  for (std::size_t i = 0; i < ticks.size(); ++i)
    EXPECT_DOUBLE_EQ(ticks[i], std::pow(10.0, static_cast<double>(i) - 4.0));
}

TEST(DecadeTicks, EndAtARangeThatEndsAtPowersOfTen) {
  const auto ticks = decade_ticks({0.001, 100.0}, 9);
  EXPECT_DOUBLE_EQ(ticks.front(), 0.001);
  EXPECT_DOUBLE_EQ(ticks.back(), 100.0);
  EXPECT_EQ(ticks.size(), 6U);
}

TEST(DecadeTicks, StayWithinTheirNumberAndStillCover) {
  for (const double low : {3e-13, 1e-6, 0.02, 7.0}) {
    for (const double ratio : {1.0, 1.5, 40.0, 1e9}) {
      for (const int most : {3, 5, 9}) {
        const auto ticks = decade_ticks({low, ratio * low}, most);
        EXPECT_LE(ticks.size(), static_cast<std::size_t>(most));
        EXPECT_GE(ticks.size(), 2U);
        EXPECT_LE(ticks.front(), low * (1.0 + 1e-8));
        EXPECT_GE(ticks.back(), ratio * low * (1.0 - 1e-8));
      }
    }
  }
}

TEST(LogAxis, EqualRatiosAreEqualLengths) {
  const PlotAxis axis{{0.001, 10.0}, Scale::kLog};
  EXPECT_NEAR(axis.place(0.001), 0.0, 1e-12);
  EXPECT_NEAR(axis.place(10.0), 1.0, 1e-12);
  EXPECT_NEAR(axis.place(0.1), 0.5, 1e-12);
  EXPECT_NEAR(axis.place(6.0) - axis.place(3.0), axis.place(0.02) - axis.place(0.01), 1e-12);
}

TEST(LogAxis, HasNoPositionForZeroOrLess) {
  const PlotAxis axis{{0.001, 10.0}, Scale::kLog};
  EXPECT_FALSE(std::isfinite(axis.place(0.0)));
  EXPECT_FALSE(std::isfinite(axis.place(-1.0)));
}

TEST(LogAxis, CountsInDecadesWithSmallTicksBetween) {
  const auto ticks = ticks_of({{0.07, 12.0}, Scale::kLog}, 9);
  EXPECT_EQ(labels_of(ticks), (std::vector<std::string>{"0.1", "1", "10"}));
  EXPECT_NEAR(ticks.front().value, 0.07, 1e-12);  // 0.07 to 0.09, then 0.1
  EXPECT_EQ(ticks.size(), 3U + 3U + 8U + 8U);     // below 0.1, decades, between 0.1 and 1, between 1 and 10
}

TEST(LogAxis, ShowsNoSmallTicksBetweenSkippedDecades) {
  for (const Tick& tick : ticks_of({{1e-9, 1e3}, Scale::kLog}, 5)) EXPECT_FALSE(tick.label.empty()) << tick.value;
}

TEST(Extent, OnALogAxisCoversPositiveValuesWithALogRim) {
  const Range range = extent_of({0.0, 0.01, -3.0, std::nan(""), 1.0}, Scale::kLog, 0.5);
  EXPECT_NEAR(range.low, 0.001, 1e-12);
  EXPECT_NEAR(range.high, 10.0, 1e-9);
}

TEST(Extent, WithoutValuesIsStillValid) {
  for (const Scale scale : {Scale::kLinear, Scale::kLog}) {
    const PlotAxis axis = to_whole_ticks({extent_of({std::nan("")}, scale, 0.04), scale}, 5);
    EXPECT_GT(axis.range.high, axis.range.low);
    EXPECT_TRUE(std::isfinite(axis.place(0.5)));
  }
}

TEST(LinearAxis, CountsInTheDigitsOfItsStep) {
  EXPECT_EQ(labels_of(ticks_of({{0.0, 1.0}}, 6)), (std::vector<std::string>{"0.0", "0.2", "0.4", "0.6", "0.8", "1.0"}));
}

}  // namespace
}  // namespace moiregauge::internal::figure
