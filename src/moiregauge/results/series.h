// SPDX-License-Identifier: Apache-2.0
// Series: one axis of one target over time, and the evenness of its sampling.
#pragma once

#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/displacement/method.h"

namespace moiregauge::internal {

// One value per frame, in time order; NaN is a gap. Only rows with status `ok` have values.
struct Series {
  std::vector<double> time_s;
  std::vector<double> value;  // mm
};

// Returns the series of one axis of a target.
[[nodiscard]] Series series_of(const Samples& samples, std::size_t marker, double Extent<frame::Board>::*axis);

// Consecutive samples without a gap. A row that is not `ok` and a missing frame are gaps.
struct Stretch {
  std::size_t first = 0, count = 0;
};

struct EvenTimes {
  double interval_s = 0.0;
  std::vector<Stretch> stretches;  // in time order
  double off_grid = 0.0;           // largest deviation of a time stamp from the even grid, intervals
  [[nodiscard]] const Stretch& longest() const;
};

// Largest accepted deviation of time stamps from an even grid, intervals. An error of e intervals gives a sine of
// frequency f an error of 2 pi e f / f_sampling of its amplitude. Stamps in whole milliseconds are wrong by up to 0.12
// intervals at 240 frames/s. Jitter of a fifth of an interval (0.12 rms) at a quarter of the sampling frequency moves 3
// % of the power elsewhere.
inline constexpr double kOffGridAllowed = 0.2;

// Returns the sampling interval and the stretches of a series.
// Fails (reason): the frames have no times, or the times are not even.
[[nodiscard]] tl::expected<EvenTimes, std::string> even_times(const Series& series);

}  // namespace moiregauge::internal
