// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/simulator/recorder.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace moiregauge::internal::simulator {
namespace {

// Returns the absolute mean difference of two images over 3 x 3 pixels. The mean suppresses noise and leaves motion.
template <typename Now, typename Other>
double difference_at(const Image<Now>& now, const Image<Other>& other, int x, int y) {
  double sum = 0.0;
  for (int v = -1; v <= 1; ++v) {
    const int row = std::clamp(y + v, 0, now.height() - 1);
    for (int u = -1; u <= 1; ++u) {
      const int column = std::clamp(x + u, 0, now.width() - 1);
      sum += static_cast<double>(now.at(column, row)) - static_cast<double>(other.at(column, row));
    }
  }
  return std::abs(sum) / 9.0;
}

template <typename Grey>
Image<double> doubles_of(const Image<Grey>& picture) {
  Image<double> made(picture.width(), picture.height());
  for (int y = 0; y < picture.height(); ++y)
    std::copy(picture.row(y).begin(), picture.row(y).end(), made.row(y).begin());
  return made;
}

template <typename Grey>
Image<Grey> rounded(const Image<double>& picture) {
  Image<Grey> made(picture.width(), picture.height());
  for (int y = 0; y < picture.height(); ++y) {
    const auto from = picture.row(y);
    const auto to = made.row(y);
    for (std::size_t x = 0; x < from.size(); ++x) to[x] = static_cast<Grey>(std::floor(from[x] + 0.5));
  }
  return made;
}

// Returns the mean of the frame and those before it, per pixel. With a threshold, a pixel of another grey does not count.
template <typename Grey>
Image<double> mean_of(const Image<Grey>& now, const std::deque<Picture>& all_before, double threshold) {
  Image<double> made = doubles_of(now), count(now.width(), now.height(), 1.0);
  const auto add = [&](const Image<Grey>& before, int x, int y) {
    if (threshold > 0.0 && difference_at(now, before, x, y) > threshold) return;
    made.at(x, y) += before.at(x, y);
    count.at(x, y) += 1.0;
  };
  for (const Picture& held : all_before) {
    const auto& before = std::get<Image<Grey>>(held);
    for (int y = 0; y < now.height(); ++y) {
      for (int x = 0; x < now.width(); ++x) add(before, x, y);
    }
  }
  for (int y = 0; y < now.height(); ++y) {
    for (int x = 0; x < now.width(); ++x) made.at(x, y) /= count.at(x, y);
  }
  return made;
}

// Returns fresh + share * (kept - fresh) per pixel. With a threshold the share falls to 0 where both differ by it.
Image<double> recursed(const Image<double>& fresh, const Image<double>& kept, double full_share, double threshold) {
  Image<double> made = fresh;
  for (int y = 0; y < fresh.height(); ++y) {
    for (int x = 0; x < fresh.width(); ++x) {
      double share = full_share;
      if (threshold > 0.0) share *= std::max(0.0, 1.0 - difference_at(fresh, kept, x, y) / threshold);
      made.at(x, y) += share * (kept.at(x, y) - made.at(x, y));
    }
  }
  return made;
}

}  // namespace

bool has_temporal_steps(const Scenario& scenario) {
  return scenario.processing.average_frames > 1 || scenario.processing.recursion > 0.0;
}

TemporalFilter::TemporalFilter(const Scenario& scenario)
    : processing_(scenario.processing), grey_(std::ldexp(1.0, scenario.sensor.bits - 8)) {}

template <typename Grey>
Image<Grey> TemporalFilter::filtered(const Image<Grey>& now) {
  const double threshold = processing_.motion_grey * grey_;
  const bool averages = processing_.average_frames > 1;
  Image<double> made = averages ? mean_of(now, before_, threshold) : doubles_of(now);
  if (averages) {
    before_.push_back(now);
    if (before_.size() >= static_cast<std::size_t>(processing_.average_frames)) before_.pop_front();
  }
  if (processing_.recursion > 0.0) {
    if (kept_) made = recursed(made, *kept_, processing_.recursion, threshold);
    kept_ = made;
  }
  return rounded<Grey>(made);
}

Picture TemporalFilter::next(Picture picture) {
  return std::visit([&](const auto& now) -> Picture { return filtered(now); }, picture);
}

Recorder::Recorder(const Scenario& scenario, const RenderOptions& options)
    : scenario_(scenario), options_(options), filter_(scenario) {}

Picture Recorder::frame(long number) {
  if (!has_temporal_steps(scenario_)) return render_still(scenario_, number, options_);
  if (number < next_) {
    filter_ = TemporalFilter(scenario_);
    next_ = 0;
  }
  while (next_ < number) static_cast<void>(filter_.next(render_still(scenario_, next_++, options_)));
  return filter_.next(render_still(scenario_, next_++, options_));
}

}  // namespace moiregauge::internal::simulator
