// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/comparison/paired_records.h"

#include <algorithm>
#include <cmath>

namespace moiregauge::internal {
namespace {

using Eigen::Index;

// The reference is interpolated unless its steps are clearly longer (chosen). Equal rates keep the frames as rows.
constexpr double kSlower = 1.25;

bool is_reference_slower(const Series& measured, const Series& reference) {
  return median_step_s(reference.time_s) > kSlower * median_step_s(measured.time_s);
}

}  // namespace

PairedRecords::PairedRecords(const Series& measured, const Series& reference)
    : measured_(measured),
      reference_(reference),
      is_channel_interpolated_(is_reference_slower(measured, reference)),
      spline_(is_channel_interpolated_ ? measured : reference) {}

Index PairedRecords::nearest_row(double time_s) const {
  const auto& t = measured_.time_s;
  const auto above = std::lower_bound(t.begin(), t.end(), time_s);
  if (above == t.begin()) return 0;
  if (above == t.end()) return static_cast<Index>(t.size()) - 1;
  return (above - t.begin()) - (*above - time_s > time_s - *(above - 1) ? 1 : 0);
}

Pairs PairedRecords::at(const TimeMap& map, std::size_t first, std::size_t last) const {
  Pairs out;
  const Series& points = slower();
  std::vector<double> slope;
  std::vector<std::size_t> point;
  for (std::size_t i = first; i < last; ++i) {
    if (!std::isfinite(points.value[i])) continue;
    const double stamp = points.time_s[i];
    const double other = is_channel_interpolated_ ? map.recording_time(stamp) : map.reference_time(stamp);
    const SplineSeries::Point between = spline_.at(other);
    if (!std::isfinite(between.value)) continue;
    if (is_channel_interpolated_)
      out.pairs.push_back({other, stamp, between.value, points.value[i], nearest_row(other)});
    else
      out.pairs.push_back({stamp, other, points.value[i], between.value, static_cast<Index>(i)});
    slope.push_back(between.slope);
    point.push_back(i);
  }
  const auto count = static_cast<Index>(out.pairs.size());
  out.by_offset = Eigen::Map<const Eigen::VectorXd>(slope.data(), count);
  out.neighbour_mean = out.neighbour_slope = Eigen::VectorXd::Zero(count);
  const double longest = 2.0 * kMaxUsualSteps * median_step_s(points.time_s);
  double sum = 0.0, inner = 0.0;
  const auto has_neighbours = [&](std::size_t k) {
    return point[k - 1] + 1 == point[k] && point[k] + 1 == point[k + 1] &&
           points.time_s[point[k + 1]] - points.time_s[point[k - 1]] <= longest;
  };
  for (std::size_t k = 1; k + 1 < point.size(); ++k) {
    if (!has_neighbours(k)) continue;
    const auto at = static_cast<Index>(k);
    const std::size_t before = point[k - 1], after = point[k + 1];
    out.neighbour_mean(at) = 0.5 * (out.pairs[k - 1].reference + out.pairs[k + 1].reference);
    out.neighbour_slope(at) =
        (points.value[after] - points.value[before]) / (points.time_s[after] - points.time_s[before]);
    sum += out.neighbour_mean(at);
    inner += 1.0;
  }
  for (std::size_t k = 1; k + 1 < point.size(); ++k) {
    if (has_neighbours(k)) out.neighbour_mean(static_cast<Index>(k)) -= sum / inner;
  }
  return out;
}

}  // namespace moiregauge::internal
