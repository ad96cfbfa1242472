// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/run/frame_notes.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

namespace moiregauge::internal {
namespace {

struct Interval {
  double begin_s = 0.0;
  double length_s = 0.0;
  double per_frame_s = 0.0;
};

std::vector<Interval> intervals(const Observations& frames) {
  std::vector<Interval> all;
  std::optional<std::pair<long, double>> last;  // frame number and time in s
  for (const Observation& frame : frames) {
    if (frame.decode_error || std::isnan(frame.time_s)) continue;
    if (last && frame.frame > last->first) {
      const double length_s = frame.time_s - last->second;
      all.push_back({last->second, length_s, length_s / static_cast<double>(frame.frame - last->first)});
    }
    last.emplace(frame.frame, frame.time_s);
  }
  return all;
}

}  // namespace

std::vector<std::string> notes_on_frames(const Observations& frames) {
  std::vector<std::string> notes;
  long first = -1, count = 0;
  for (const Observation& frame : frames) {
    if (frame.decode_error && ++count == 1) first = frame.frame;
  }
  if (count > 0)
    notes.push_back(
        fmt::format("{} frame{} no values (decode-error): the input is damaged from frame {} on. Copy the recording "
                    "again from the camera",
                    count, count == 1 ? " has" : "s have", first));
  std::vector<Interval> all = intervals(frames);
  const auto shorter = [](const Interval& a, const Interval& b) { return a.per_frame_s < b.per_frame_s; };
  if (all.size() < 2) return notes;
  const Interval largest = *std::max_element(all.begin(), all.end(), shorter);
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end(), shorter);
  constexpr double kRounding = 1e-3;  // s: Matroska rounds time stamps to 1 ms
  if (largest.per_frame_s > 1.5 * middle->per_frame_s + kRounding) {
    notes.push_back(
        fmt::format("note: the frame rate varies (largest gap {:.2f} s at {:.2f} s). The stream's own times are used",
                    largest.length_s, largest.begin_s));
  }
  return notes;
}

}  // namespace moiregauge::internal
