// SPDX-License-Identifier: Apache-2.0
// Serves the newest values and the run's condition to Prometheus.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/live/publish/block_text.h"
#include "moiregauge/live/publish/http.h"
#include "moiregauge/live/publisher.h"

namespace moiregauge::internal {

// Facts that other publishers know. Called on the server's threads.
struct MetricsFacts {
  std::function<std::vector<std::pair<std::string, bool>>()> alarms;
  std::function<std::vector<std::pair<std::string, long>>()> lost_rows;
};

class MetricsPublisher final : public Publisher {
 public:
  // Serves http://HOST:PORT/metrics. Fails with the reason.
  [[nodiscard]] static tl::expected<std::unique_ptr<MetricsPublisher>, std::string> open(const std::string& host,
                                                                                         int port, MetricsFacts facts);
  void start(const LiveRun& run) override;
  void put(const PublishedFrame& frame) override;
  // Ends the server. Later requests are refused.
  void finish(double /*seconds*/) override { server_.reset(); }
  [[nodiscard]] std::pair<std::string, std::string> state() const override;
  [[nodiscard]] std::string page() const;

 private:
  explicit MetricsPublisher(MetricsFacts facts) : facts_(std::move(facts)) {}

  MetricsFacts facts_;
  mutable std::mutex mutex_;
  MetricsPage page_;
  std::string address_;
  std::unique_ptr<PageServer> server_;  // last: its threads use the other members
};

}  // namespace moiregauge::internal
