// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/series.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace moiregauge::internal {
namespace {

// Returns the mean of the steps near the median. Dropped frames make longer steps, which do not count.
double usual_step(const std::vector<double>& t) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < t.size(); ++i) steps.push_back(t[i] - t[i - 1]);
  std::vector<double> sorted = steps;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double median = *middle;
  double sum = 0.0;
  long count = 0;
  for (const double step : steps) {
    if (step < 0.5 * median || step > 1.5 * median) continue;
    sum += step;
    ++count;
  }
  return count > 0 ? sum / static_cast<double>(count) : 0.0;
}

// Returns half the range of the deviations of time stamps from an even grid, intervals.
double off_grid(const std::vector<double>& t, const Stretch& stretch, double interval) {
  double lowest = 0.0, highest = 0.0;
  for (std::size_t i = 0; i < stretch.count; ++i) {
    const double off = t[stretch.first + i] - t[stretch.first] - static_cast<double>(i) * interval;
    lowest = std::min(lowest, off);
    highest = std::max(highest, off);
  }
  return 0.5 * (highest - lowest) / interval;
}

}  // namespace

Series series_of(const Samples& samples, std::size_t marker, double Extent<frame::Board>::*axis) {
  Series series;
  for (const Sample& sample : samples) {
    if (sample.marker != marker) continue;
    series.time_s.push_back(sample.time_s);
    series.value.push_back(sample.status == Status::kOk ? sample.displacement.*axis : kNotMeasured);
  }
  return series;
}

const Stretch& EvenTimes::longest() const {
  return *std::max_element(stretches.begin(), stretches.end(),
                           [](const Stretch& a, const Stretch& b) { return a.count < b.count; });
}

tl::expected<EvenTimes, std::string> even_times(const Series& series) {
  const std::vector<double>& t = series.time_s;
  if (std::any_of(t.begin(), t.end(), [](double v) { return !std::isfinite(v); }))
    return tl::unexpected(std::string("the frames have no times, so measure with --fps"));
  EvenTimes times;
  times.interval_s = t.size() < 2 ? 0.0 : usual_step(t);
  if (!(times.interval_s > 0.0)) return tl::unexpected(std::string("the times do not increase from frame to frame"));
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (std::isnan(series.value[i])) continue;
    const bool follows =
        i > 0 && !std::isnan(series.value[i - 1]) && std::lround((t[i] - t[i - 1]) / times.interval_s) == 1;
    if (follows)
      ++times.stretches.back().count;
    else
      times.stretches.push_back({i, 1});
  }
  if (times.stretches.empty()) return tl::unexpected(std::string("no ok row has a value along this axis"));
  for (const Stretch& stretch : times.stretches)
    times.off_grid = std::max(times.off_grid, off_grid(t, stretch, times.interval_s));
  if (times.off_grid > kOffGridAllowed)
    return tl::unexpected(
        fmt::format("the time stamps deviate from an even grid by up to {:.2f} intervals, and {} is the limit",
                    times.off_grid, kOffGridAllowed));
  return times;
}

}  // namespace moiregauge::internal
