// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/comparison/spline_series.h"

#include <algorithm>
#include <cmath>

namespace moiregauge::internal {

double median_step_s(const std::vector<double>& time_s) {
  if (time_s.size() < 2) return 0.0;
  std::vector<double> steps;
  steps.reserve(time_s.size() - 1);
  for (std::size_t i = 1; i < time_s.size(); ++i) steps.push_back(time_s[i] - time_s[i - 1]);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

SplineSeries::SplineSeries(const Series& series) {
  const double longest = kMaxUsualSteps * median_step_s(series.time_s);
  bool follows = false;
  for (std::size_t i = 0; i < series.time_s.size(); ++i) {
    if (!std::isfinite(series.value[i])) continue;
    if (!time_s_.empty()) follows = series.time_s[i] - time_s_.back() <= longest;
    if (!time_s_.empty()) is_joined_.push_back(follows);
    time_s_.push_back(series.time_s[i]);
    value_.push_back(series.value[i]);
  }
  is_joined_.push_back(false);
  second_.assign(time_s_.size(), 0.0);
  for (std::size_t first = 0; first < time_s_.size();) {
    std::size_t last = first;
    while (is_joined_[last]) ++last;
    if (last > first + 1) bend(first, last);
    first = last + 1;
  }
}

// Solves the tridiagonal equations of the second derivatives; they are 0 at both ends.
void SplineSeries::bend(std::size_t first, std::size_t last) {
  std::vector<double> upper(last - first, 0.0);
  for (std::size_t i = first + 1; i < last; ++i) {
    const double before = time_s_[i] - time_s_[i - 1], after = time_s_[i + 1] - time_s_[i];
    const double bend_of = 6.0 * ((value_[i + 1] - value_[i]) / after - (value_[i] - value_[i - 1]) / before);
    const double pivot = 2.0 * (before + after) - before * upper[i - 1 - first];
    upper[i - first] = after / pivot;
    second_[i] = (bend_of - before * second_[i - 1]) / pivot;
  }
  for (std::size_t i = last - 1; i > first; --i) second_[i] -= upper[i - first] * second_[i + 1];
}

SplineSeries::Point SplineSeries::at(double time_s) const {
  if (time_s_.size() < 2 || !(time_s >= time_s_.front()) || !(time_s <= time_s_.back())) return {};
  const auto above = std::upper_bound(time_s_.begin(), time_s_.end(), time_s);
  const std::size_t i = std::min(static_cast<std::size_t>(above - time_s_.begin()), time_s_.size() - 1) - 1;
  if (!is_joined_[i]) return {};
  const double h = time_s_[i + 1] - time_s_[i], b = (time_s - time_s_[i]) / h, a = 1.0 - b;
  const double value = a * value_[i] + b * value_[i + 1] +
                       ((a * a * a - a) * second_[i] + (b * b * b - b) * second_[i + 1]) * h * h / 6.0;
  const double slope = (value_[i + 1] - value_[i]) / h +
                       ((3.0 * b * b - 1.0) * second_[i + 1] - (3.0 * a * a - 1.0) * second_[i]) * h / 6.0;
  return {value, slope};
}

}  // namespace moiregauge::internal
