// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/drawing/figures/figure_run.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace moiregauge::internal::figure {
namespace {

Curve of_length(std::size_t count) {
  Curve curve;
  for (std::size_t i = 0; i < count; ++i) {
    const double y = std::sin(0.37 * static_cast<double>(i));
    curve.x.push_back(static_cast<double>(i));
    curve.y.push_back(y);
    curve.low.push_back(y - 0.1);
    curve.high.push_back(y + 0.1);
  }
  return curve;
}

TEST(ThinnedCurve, AShortCurveIsUnchanged) { EXPECT_EQ(thinned(of_length(100), 100).y, of_length(100).y); }

// A single outlier in a long record must stay visible.
TEST(ThinnedCurve, KeepsOutliersAndTheirOrder) {
  Curve curve = of_length(100000);
  curve.y[54321] = 7.0;
  curve.y[54322] = -7.0;
  const Curve thin = thinned(curve, 1000);
  EXPECT_LE(thin.x.size(), 1500U);
  EXPECT_EQ(*std::max_element(thin.y.begin(), thin.y.end()), 7.0);
  EXPECT_EQ(*std::min_element(thin.y.begin(), thin.y.end()), -7.0);
  EXPECT_TRUE(std::is_sorted(thin.x.begin(), thin.x.end()));
}

TEST(ThinnedCurve, KeepsGaps) {
  Curve curve = of_length(10000);
  curve.y[5000] = kNotMeasured;
  const Curve thin = thinned(curve, 100);
  EXPECT_EQ(std::count_if(thin.y.begin(), thin.y.end(), [](double y) { return std::isnan(y); }), 1);
}

}  // namespace
}  // namespace moiregauge::internal::figure
