// SPDX-License-Identifier: Apache-2.0
// One axis of one target over time, and how evenly it was sampled.
#pragma once

#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/displacement/method.h"

namespace moiregauge::internal {

// A value per frame, in time order; NaN is a gap. Spectra and fits stand on rows with status `ok` alone.
struct Series {
  std::vector<double> time_s;
  std::vector<double> value;  // mm
};

[[nodiscard]] Series series_of(const Samples& samples, std::size_t marker, double Extent<frame::Board>::*axis);

// Consecutive samples without a gap: neither a row that is not `ok` nor a missing frame.
struct Stretch {
  std::size_t first = 0, count = 0;
};

struct EvenTimes {
  double interval_s = 0.0;
  std::vector<Stretch> stretches;  // in time order
  double off_grid = 0.0;           // the furthest that a time stamp lies off the even grid, intervals
  [[nodiscard]] const Stretch& longest() const;
};

// A time stamp that is wrong by a part e of an interval makes of a sine of frequency f an error of 2 pi e f /
// f_sampling of its amplitude. Stamps in whole milliseconds are wrong by up to 0.12 intervals at 240 frames/s; jitter
// of a fifth of an interval (0.12 rms) at a quarter of the sampling frequency leaves 3 % of the power elsewhere. Beyond
// it is refused.
inline constexpr double kOffGridAllowed = 0.2;

// fails   why there is no even grid: no times, or times that wander
[[nodiscard]] tl::expected<EvenTimes, std::string> even_times(const Series& series);

}  // namespace moiregauge::internal
