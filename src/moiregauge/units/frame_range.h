// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>
#include <optional>

namespace moiregauge::internal {

// Times first <= t < end, s, on the clock of `time_s`.
struct TimeRange {
  double first_s = 0.0;
  double end_s = std::numeric_limits<double>::infinity();
};

// Frames A:B:STEP of an input. B is excluded. With `seconds` their times select the frames, not `first` and `end`.
struct FrameRange {
  long first = 0;
  long end = -1;  // -1: to the end
  long step = 1;
  std::optional<TimeRange> seconds = std::nullopt;
  // Not for a range in seconds, which in_frames() or FrameSelector converts.
  [[nodiscard]] bool holds(long frame) const {
    return frame >= first && (end < 0 || frame < end) && (frame - first) % step == 0;
  }
};

// Selects frames that arrive in the order of their times, by a range in frames or in seconds. STEP counts from the
// first frame in the range.
class FrameSelector {
 public:
  explicit FrameSelector(const FrameRange& range) : range_(range) {}
  // A frame without a time is in the range if it follows a frame in it.
  [[nodiscard]] bool holds(long frame, double time_s) {
    if (!range_.seconds) return range_.holds(frame);
    if (is_past(frame, time_s)) has_ended_ = true;
    if (has_ended_) return false;
    if (first_ < 0 && !(time_s >= range_.seconds->first_s - kSameTime_s)) return false;
    if (first_ < 0) first_ = frame;
    return (frame - first_) % range_.step == 0;
  }
  // Returns true if neither this frame nor a later one is in the range.
  [[nodiscard]] bool is_past(long frame, double time_s) const {
    if (range_.seconds) return time_s >= range_.seconds->end_s - kSameTime_s;
    return range_.end >= 0 && frame >= range_.end;
  }

 private:
  // Times that differ by less are equal. It is far below any frame interval, and above rounding of a day in seconds.
  static constexpr double kSameTime_s = 1e-9;
  FrameRange range_;
  long first_ = -1;  // first frame in a range in seconds; -1: not reached
  bool has_ended_ = false;
};

// Returns the range in frames, for observations or samples (fields `frame` and `time_s`) in the order of time.
// Nothing: it holds none of them.
template <typename Frames>
[[nodiscard]] std::optional<FrameRange> in_frames(const FrameRange& range, const Frames& frames) {
  FrameSelector selector(range);
  std::optional<FrameRange> found;
  for (const auto& seen : frames) {
    if (!selector.holds(seen.frame, seen.time_s)) continue;
    if (!found) found = FrameRange{seen.frame, -1, range.step};
    found->end = seen.frame + 1;
  }
  if (found && !range.seconds) return range;
  if (found && std::isinf(range.seconds->end_s)) found->end = -1;
  return found;
}

}  // namespace moiregauge::internal
