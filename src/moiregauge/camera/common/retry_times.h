// SPDX-License-Identifier: Apache-2.0
// Times at which a lost source is tried again.
#pragma once

#include <algorithm>
#include <chrono>
#include <thread>

namespace moiregauge::internal {

// The first attempt is due at once, the second 0.25 s later. Each further interval is twice as long, at most 2 s.
// These times are chosen so that a camera is back within 5 s of its power.
class RetryTimes {
 public:
  using Clock = std::chrono::steady_clock;
  explicit RetryTimes(std::chrono::milliseconds patience) : patience_(patience) {}

  // Starts with the loss of the source. The first attempt is due at once.
  void begin() {
    lost_at_ = Clock::now();
    due_ = lost_at_;
    wait_ = std::chrono::milliseconds(250);
  }
  // Sleeps until the next attempt is due, but not beyond `until`. Returns true if it is due.
  [[nodiscard]] bool wait(Clock::time_point until) const {
    std::this_thread::sleep_until(std::min(due_, until));
    return Clock::now() >= due_;
  }
  // Schedules the next attempt. Returns true if patience is exhausted.
  [[nodiscard]] bool failed() {
    due_ = Clock::now() + wait_;
    wait_ = std::min(2 * wait_, std::chrono::milliseconds(2000));
    return Clock::now() - lost_at_ >= patience_;
  }

 private:
  std::chrono::milliseconds patience_;
  std::chrono::milliseconds wait_{250};
  Clock::time_point lost_at_;
  Clock::time_point due_;
};

}  // namespace moiregauge::internal
