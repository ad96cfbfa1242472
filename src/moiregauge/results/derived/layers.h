// SPDX-License-Identifier: Apache-2.0
// Layers on a channel's series: zero, detrend, filters, resampling, velocity and moving median, one after the other
// (docs/cli/derive.md).
#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/results/derived/channel_values.h"
#include "moiregauge/results/derived/time_operator.h"
#include "moiregauge/units/frame_range.h"

namespace moiregauge::internal {

struct ZeroLayer {  // subtracts the mean over these frames
  FrameRange frames;
};
struct DetrendLayer {};  // subtracts the least squares line
// Zero-phase filter: a windowed sinc, symmetric about every row.
struct FilterLayer {
  double low_hz = 0.0;   // 0: passes low frequencies
  double high_hz = 0.0;  // 0: passes high frequencies
};
struct VelocityLayer {  // derivative of the series below this frequency
  double below_hz = 0.0;
};
struct ResampleLayer {  // even times by linear interpolation
  double rate_hz = 0.0;
};
struct MedianLayer {  // moving median of an odd number of rows
  int rows = 1;
};

struct Layer {
  std::variant<ZeroLayer, DetrendLayer, FilterLayer, VelocityLayer, ResampleLayer, MedianLayer> what;
  std::string text;  // as typed, e.g. "filter lowpass:5Hz"
};

// Reads the value of an option: "filter" ("lowpass:5Hz", "highpass:0.2Hz", "bandpass:1Hz-5Hz"), "velocity" and
// "resample" ("5Hz"), "median" ("5"). Fails with what to write.
[[nodiscard]] tl::expected<Layer, std::string> parse_layer(std::string_view option, std::string_view value);

// A series after its layers. Rows without a value are NaN: they are nearer to a gap or an end than the filter's half
// width, or they were not measured.
struct LayeredSeries {
  std::vector<double> time_s;
  std::vector<long> frame;  // empty after resampling
  std::vector<Status> status;
  Eigen::VectorXd value, u;
  std::string unit;
  bool is_u_of_median = false;  // a median was taken: u is that of unfiltered samples, an upper bound
  // Input and operator, for statistics over rows.
  ChannelSeries base;
  TimeOperator by_base = TimeOperator::identity({});
};

// Applies the layers in their order. `unit`: of the channel.
// Fails with "what: what to do". Reasons are uneven times, a frequency beyond half the rate, a record that is too short,
// and a zero without ok rows.
[[nodiscard]] tl::expected<LayeredSeries, std::string> layered(ChannelSeries series, const std::string& unit,
                                                               const std::vector<Layer>& layers);

// Returns the value and u of a weighted sum of rows. Weights of rows without a value must be zero.
struct ValueWithU {
  double value = kNotMeasured, u = kNotMeasured;
};
[[nodiscard]] ValueWithU weighted_sum(const LayeredSeries& series, const Eigen::VectorXd& weights);

}  // namespace moiregauge::internal
