// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/derived/statistics.h"

#include <cmath>

namespace moiregauge::internal {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

Extreme extreme_at(const LayeredSeries& series, Index row) {
  VectorXd weights = VectorXd::Zero(series.value.size());
  weights(row) = 1.0;
  const auto at = static_cast<std::size_t>(row);
  return {weighted_sum(series, weights), series.time_s[at], series.frame.empty() ? -1 : series.frame[at]};
}

}  // namespace

ChannelStatistics statistics_of(const LayeredSeries& series) {
  ChannelStatistics out;
  const Index rows = series.value.size();
  out.rows = static_cast<long>(rows);
  VectorXd used = VectorXd::Zero(rows), off = used;
  Index low = -1, high = -1;
  double variance = 0.0;
  for (Index n = 0; n < rows; ++n) {
    if (series.status[static_cast<std::size_t>(n)] != Status::kOk || std::isnan(series.value(n))) continue;
    used(n) = 1.0;
    ++out.ok;
    variance += series.u(n) * series.u(n);
    if (low < 0 || series.value(n) < series.value(low)) low = n;
    if (high < 0 || series.value(n) > series.value(high)) high = n;
  }
  if (out.ok == 0) return out;
  const auto count = static_cast<double>(out.ok);
  out.u_rms = std::sqrt(variance / count);
  out.mean = weighted_sum(series, used / count);
  for (Index n = 0; n < rows; ++n) {
    if (used(n) > 0.0) off(n) = series.value(n) - out.mean.value;
  }
  const double rms = std::sqrt(off.squaredNorm() / count);
  out.rms = {rms, rms > 0.0 ? weighted_sum(series, off / (count * rms)).u : 0.0};
  out.smallest = extreme_at(series, low);
  out.largest = extreme_at(series, high);
  VectorXd range = VectorXd::Zero(rows);
  range(high) += 1.0;
  range(low) -= 1.0;
  out.peak_to_peak = weighted_sum(series, range);
  return out;
}

}  // namespace moiregauge::internal
