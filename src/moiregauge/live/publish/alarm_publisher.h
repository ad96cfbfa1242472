// SPDX-License-Identifier: Apache-2.0
// Evaluates alarm rules on every frame.
#pragma once

#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "moiregauge/live/publish/alarm_state.h"
#include "moiregauge/live/publisher.h"
#include "moiregauge/live/row_block.h"

namespace moiregauge::internal {

// Only rows with the status `ok` count: others are not trusted, and prove neither an alarm nor its end.
class AlarmPublisher final : public Publisher {
 public:
  // `log`: a CSV file to which every change is appended; empty: none. The listeners must outlive this object.
  AlarmPublisher(const std::vector<AlarmRule>& rules, std::string log, std::vector<AlarmListener*> listeners);
  void start(const LiveRun& run) override;
  void put(const PublishedFrame& frame) override;
  void finish(double /*seconds*/) override {}
  // Returns {"alarm", "T1.dy > 2 mm"} with all raised rules. A rule on a marker without rows gives "no target 'T1'".
  [[nodiscard]] std::pair<std::string, std::string> state() const override;
  // Returns the rules, and true for raised ones. Any thread.
  [[nodiscard]] std::vector<std::pair<std::string, bool>> all() const;

 private:
  void log(const AlarmEvent& event) const;

  mutable std::mutex mutex_;
  std::vector<AlarmState> states_;
  std::vector<std::size_t> markers_;  // index into LiveRun::markers, one per rule
  bool is_started_ = false;
  std::string log_;
  std::vector<AlarmListener*> listeners_;
};

// Header of the log.
inline constexpr const char* kAlarmLogHeader = "utc_ns,frame,time_s,state,rule,value_mm\n";

}  // namespace moiregauge::internal
