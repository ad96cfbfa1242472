// SPDX-License-Identifier: Apache-2.0
// Shows a live run: one line on a terminal, or JSON lines on stdout, once a second. Alarms have lines of their own.
#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "moiregauge/live/publisher.h"
#include "moiregauge/live/row_block.h"

namespace moiregauge::internal::cli {

enum class LiveOutput { kNothing, kLine, kJsonLines };

// Returns the line of a terminal.
[[nodiscard]] std::string live_line(const LiveRun& run, const PublishedFrame& frame);
// Returns a JSON line (docs/cli/live.md), without its end.
[[nodiscard]] std::string live_json_line(const LiveRun& run, const PublishedFrame& frame);

// Returns the line of an alarm, for stderr.
[[nodiscard]] std::string alarm_line(const AlarmEvent& event);

// A thread prints the newest frame, so that a terminal that is stopped does not stop the measurement.
class LiveDisplay final : public Publisher, public AlarmListener {
 public:
  explicit LiveDisplay(LiveOutput output);
  LiveDisplay(const LiveDisplay&) = delete;
  LiveDisplay& operator=(const LiveDisplay&) = delete;
  ~LiveDisplay() override = default;
  void start(const LiveRun& run) override;
  void put(const PublishedFrame& frame) override;
  void finish(double seconds) override;
  void alarm(const AlarmEvent& event) override;

 private:
  void work(const std::stop_token& stop);
  void show_alarms(const std::vector<AlarmEvent>& events);
  void show(const LiveRun& run, const PublishedFrame& frame);
  const LiveOutput output_;
  const bool shows_alarms_;  // also where stderr is no terminal
  std::mutex mutex_;
  std::condition_variable_any stopped_;
  std::optional<LiveRun> run_;
  std::optional<PublishedFrame> newest_;
  std::vector<AlarmEvent> alarms_;  // not yet shown
  bool is_shown_ = false;           // thread only
  std::jthread thread_;             // last: it uses all members above
};

}  // namespace moiregauge::internal::cli
