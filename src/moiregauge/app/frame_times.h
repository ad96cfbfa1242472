// SPDX-License-Identifier: Apache-2.0
// Time of a run, split into waiting for the next frame and measuring the present one.
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
  // Returns the share since the second frame was requested; nothing before. The first frame also sets up the reference.
  [[nodiscard]] std::optional<double> waiting_share() const {
    const Duration both = waiting_ + measuring_;
    if (both <= Duration::zero()) return std::nullopt;
    return std::chrono::duration<double>(waiting_) / std::chrono::duration<double>(both);
  }

 private:
  Duration waiting_{};
  Duration measuring_{};
};

// Returns a source of the same frames that updates `times`, which must outlive it.
[[nodiscard]] std::unique_ptr<FrameSource> timed(std::unique_ptr<FrameSource> source, FrameTimes& times);

}  // namespace moiregauge::internal
