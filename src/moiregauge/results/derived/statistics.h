// SPDX-License-Identifier: Apache-2.0
// Statistics of a channel over its rows, with their u by the joint covariance.
#pragma once

#include "moiregauge/results/derived/layers.h"

namespace moiregauge::internal {

struct Extreme {
  ValueWithU value;
  double time_s = kNotMeasured;
  long frame = -1;  // -1: the rows are no frames
};

// Rows that are `ok` and have a value. NaN if there are none.
struct ChannelStatistics {
  long rows = 0, ok = 0;
  ValueWithU mean;
  ValueWithU rms;           // about the mean
  ValueWithU peak_to_peak;  // largest minus smallest
  Extreme smallest, largest;
  double u_rms = kNotMeasured;  // root mean square of the rows' u
};

// Returns the statistics. The u of an rms is linear in the errors: near zero movement the rms is that of the noise.
// Extremes are chosen from noisy rows, so they are further apart than those of the true movement.
[[nodiscard]] ChannelStatistics statistics_of(const LayeredSeries& series);

}  // namespace moiregauge::internal
