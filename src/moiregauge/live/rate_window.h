// SPDX-License-Identifier: Apache-2.0
// Latency and rate over the last frames, in constant memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "moiregauge/live/publisher.h"

namespace moiregauge::internal {

class RateWindow {
 public:
  // Adds a frame: complete at `complete_ns`, its rows ready at `ready_ns`, both on the same clock.
  void add(std::int64_t complete_ns, std::int64_t ready_ns);
  // Writes the percentiles and the rate of the last frames. They are updated with every 16th frame.
  void describe(LiveHealth& health) const;

 private:
  void update();
  static constexpr std::size_t kFrames = 1024;
  std::array<double, kFrames> latency_ms_{};
  std::array<std::int64_t, kFrames> complete_ns_{};
  std::size_t count_ = 0;
  double p50_ms_ = kNotMeasured, p99_ms_ = kNotMeasured, per_s_ = kNotMeasured;
};

}  // namespace moiregauge::internal
