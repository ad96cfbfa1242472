// SPDX-License-Identifier: Apache-2.0
// Every row of a live run as JSON lines on stderr, ten times a second (--progress json).
#pragma once

#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "moiregauge/cli/common/sample_lines.h"
#include "moiregauge/live/publisher.h"

namespace moiregauge::internal::cli {

// A thread writes, so that a reader that is stopped does not stop the measurement.
class LiveSamples final : public Publisher {
 public:
  LiveSamples();
  LiveSamples(const LiveSamples&) = delete;
  LiveSamples& operator=(const LiveSamples&) = delete;
  ~LiveSamples() override = default;
  void start(const LiveRun& run) override;
  void put(const PublishedFrame& frame) override;
  void finish(double seconds) override;

 private:
  void work(const std::stop_token& stop);
  void write();
  std::mutex mutex_;  // protects the two below
  std::vector<std::string> markers_;
  SampleLines rows_;
  std::jthread thread_;  // last: it uses all members above
};

}  // namespace moiregauge::internal::cli
