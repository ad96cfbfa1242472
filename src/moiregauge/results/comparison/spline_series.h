// SPDX-License-Identifier: Apache-2.0
// Interpolates a series between its samples by natural cubic splines. A gap ends a spline.
#pragma once

#include <vector>

#include "moiregauge/results/series.h"

namespace moiregauge::internal {

// Longest step between samples of one spline, in usual steps (chosen). A longer one is a gap. One lost sample is not.
inline constexpr double kMaxUsualSteps = 2.5;

// Returns the median step of a series, s; 0 for fewer than two samples.
[[nodiscard]] double median_step_s(const std::vector<double>& time_s);

class SplineSeries {
 public:
  struct Point {
    double value = kNotMeasured, slope = kNotMeasured;  // slope per s
  };
  // `series`: times increase; values that are not finite are gaps.
  explicit SplineSeries(const Series& series);
  // Returns value and slope at a time; NaN in a gap and outside the series.
  // Error: of the order h^4/384 times the fourth derivative, h the step. Noise of the samples remains.
  [[nodiscard]] Point at(double time_s) const;

 private:
  void bend(std::size_t first, std::size_t last);
  std::vector<double> time_s_, value_, second_;  // second derivatives
  std::vector<bool> is_joined_;                  // sample i with sample i + 1
};

}  // namespace moiregauge::internal
