// SPDX-License-Identifier: Apache-2.0
// The endless loop of a live run: takes frames from the source, measures and publishes them.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "moiregauge/live/live_tracker.h"

namespace moiregauge::internal {

struct LiveLoopHooks {
  std::vector<Publisher*> publishers;
  std::function<bool()> should_stop;                       // asked at least ten times a second; may be empty
  std::function<void(const LiveFrame&)> before_frame;      // may be empty
  std::function<void()> on_reference;                      // called once the reference frame is known; may be empty
  double max_s = std::numeric_limits<double>::infinity();  // --for
};

enum class LiveStop {
  kStopped,   // should_stop, or max_s
  kFinished,  // the source came to its regular end
  kLost,      // the source was lost
  kUnstored,  // observations cannot be stored
  kNoFrames,  // the source ended before its first frame
  kRefused,   // no frame can be the reference frame, or the source contradicts the options
};

struct LiveEnd {
  LiveStop why = LiveStop::kStopped;
  std::string message;  // reason stated by the source; may be empty
};

// Runs until an end. Afterwards the publishers have everything, but are not finished.
[[nodiscard]] LiveEnd run_live_loop(LiveSource& source, LiveTracker& tracker, const LiveLoopHooks& hooks);

}  // namespace moiregauge::internal
