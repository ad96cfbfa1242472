// SPDX-License-Identifier: Apache-2.0
// Where the time of a run goes: into waiting for the next frame, or into measuring the one at hand.
#pragma once

#include <chrono>
#include <memory>
#include <optional>

#include "moiregauge/run/frame_source.h"

namespace moiregauge::internal {

class FrameTimes {
 public:
  using Duration = std::chrono::steady_clock::duration;
  void add_waiting(Duration d) { waiting_ += d; }
  void add_measuring(Duration d) { measuring_ += d; }
  // Of the time since the second frame was asked for: the first one also sets up the reference. Nothing before that.
  [[nodiscard]] std::optional<double> waiting_share() const {
    const Duration both = waiting_ + measuring_;
    if (both <= Duration::zero()) return std::nullopt;
    return std::chrono::duration<double>(waiting_) / std::chrono::duration<double>(both);
  }

 private:
  Duration waiting_{};
  Duration measuring_{};
};

// The same frames; `times` outlives it and is kept up to date.
[[nodiscard]] std::unique_ptr<FrameSource> timed(std::unique_ptr<FrameSource> source, FrameTimes& times);

}  // namespace moiregauge::internal
