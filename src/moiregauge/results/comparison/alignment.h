// SPDX-License-Identifier: Apache-2.0
// Aligns a measured channel with the record of another sensor: time offset, clock rate, slope and bias.
//
// Model: measured(t) = bias + slope * reference(t + offset + rate * (t - middle)).
// Sign: the clock of the reference shows the recording's time plus the offset. A positive offset means that its time
// stamps are the larger ones. A positive rate means that its clock is faster. A slope above 1 means that the channel
// shows more movement than the reference.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <tl/expected.hpp>

#include "moiregauge/results/derived/channel_values.h"
#include "moiregauge/results/series.h"

namespace moiregauge::internal {

struct Estimate {
  double value = 0.0;
  double u = kNotMeasured;          // from the residuals, with their autocorrelation
  double u_channel = kNotMeasured;  // share of the channel's factors that all rows have in common
};

// Values of both records at one moment.
struct AlignedPair {
  double time_s = 0.0;  // on the recording's clock
  double reference_time_s = 0.0;
  double measured = 0.0, reference = 0.0;
  Eigen::Index row = 0;  // in the channel; the nearest one if the channel is interpolated
};

struct Alignment {
  double middle_s = 0.0;  // middle of the common time, recording's clock; the offset is the one at this time
  Estimate offset_s, rate, slope, bias;  // rate: s per s; bias: the mean difference
  bool has_rate = false;                 // false: the record does not determine the rate, which is fixed at 0
  bool is_channel_interpolated = false;  // the reference is the slower one, and the pairs are at its times
  double residual_rms = 0.0;             // after the fit of slope and bias
  double residual_autocorrelation = 0.0;
  std::vector<AlignedPair> pairs;
};

inline constexpr std::size_t kMinPairs = 20;  // least number of rows and pairs (chosen)

// A clock rate is fitted if its u is below this, or if it differs from 0 by four u. Quartz clocks agree to 1e-4.
inline constexpr double kMaxRateU = 1e-4;
// u of a rate that is fixed at 0. Clocks of cameras and loggers are within 100 ppm (rectangular distribution).
inline constexpr double kFixedRateU = 5.8e-5;

// Returns the `ok` rows of a channel as a series; others are gaps.
[[nodiscard]] Series ok_series(const ChannelSeries& channel);

// Fits the model to the `ok` rows, starting at an offset known to 1.5 `step_s`.
// The faster record is interpolated to the times of the slower one by cubic splines, never over gaps.
// The fit solves sum w z e = 0 for the errors e, with weights w by the noise of the rows. The instruments z of a pair
// are 1, the mean of the reference at its neighbours, and the slope between its neighbours. Noise of one sample is in
// neither of them. Least squares would shift the offset to where interpolation averages noise best, and lower the
// slope.
// A slow clock moves a long record by more than its movement allows. So the fit starts with a part of the record, where
// most movement is, and doubles it.
// Fails (reason): fewer than kMinPairs pairs, or no movement in them.
[[nodiscard]] tl::expected<Alignment, std::string> fit_alignment(const ChannelSeries& channel, const Series& reference,
                                                                 double offset_s, double step_s);

}  // namespace moiregauge::internal
