// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/live_loop.h"

#include <cmath>
#include <optional>
#include <utility>

#include "moiregauge/live/clocks.h"

namespace moiregauge::internal {
namespace {

constexpr std::chrono::milliseconds kTimeout{100};  // a stop request waits no longer

// Time since the first frame, by the frames' times while they come, else by the host's clock.
class RunTime {
 public:
  void add(const LiveFrame& frame) {
    if (!first_) first_ = frame.frame.time_s;
    if (!first_ns_) first_ns_ = frame.host_ns;
    by_frames_s_ = frame.frame.time_s - *first_;
  }
  [[nodiscard]] bool is_over(double max_s, bool is_silent) const {
    if (!first_) return false;
    if (!is_silent && !std::isnan(by_frames_s_)) return by_frames_s_ >= max_s;
    constexpr double kNsPerS = 1e9;
    return static_cast<double>(steady_ns() - *first_ns_) / kNsPerS >= max_s;
  }

 private:
  std::optional<double> first_;
  std::optional<std::int64_t> first_ns_;
  double by_frames_s_ = 0.0;
};

class LiveLoop {
 public:
  LiveLoop(LiveSource& source, LiveTracker& tracker, const LiveLoopHooks& hooks)
      : source_(source), tracker_(tracker), hooks_(hooks) {}

  LiveEnd run() {
    while (!hooks_.should_stop || !hooks_.should_stop()) {
      const auto frame = source_.next(kTimeout);
      if (!frame) return end_of(frame.error());
      if (*frame && !tracker_.has_passed(**frame)) time_.add(**frame);
      if (time_.is_over(hooks_.max_s, !*frame)) return {};
      if (!*frame) continue;
      ++frames_;
      publish(**frame);
      if (!tracker_.log().contradiction.empty() || tracker_.cannot_succeed()) return {LiveStop::kRefused, {}};
      if (!tracker_.may_continue()) return {LiveStop::kUnstored, {}};
    }
    return {};
  }

 private:
  [[nodiscard]] LiveEnd end_of(const SourceEnd& end) const {
    if (end.kind == SourceEnd::Kind::kLost) return {LiveStop::kLost, end.message};
    return {frames_ == 0 ? LiveStop::kNoFrames : LiveStop::kFinished, end.message};
  }

  void publish(const LiveFrame& frame) {
    if (hooks_.before_frame) hooks_.before_frame(frame);
    const auto measured = tracker_.measure(frame, source_);
    if (!std::exchange(is_started_, tracker_.log().reference.has_value()) && is_started_) start();
    if (!measured) return;
    for (Publisher* publisher : hooks_.publishers) publisher->put(*measured);
    tracker_.published(*measured);
  }

  void start() {
    if (hooks_.on_reference) hooks_.on_reference();
    const LiveRun run = tracker_.description();
    for (Publisher* publisher : hooks_.publishers) publisher->start(run);
  }

  LiveSource& source_;
  LiveTracker& tracker_;
  const LiveLoopHooks& hooks_;
  RunTime time_;
  long frames_ = 0;
  bool is_started_ = false;
};

}  // namespace

LiveEnd run_live_loop(LiveSource& source, LiveTracker& tracker, const LiveLoopHooks& hooks) {
  return LiveLoop(source, tracker, hooks).run();
}

}  // namespace moiregauge::internal
