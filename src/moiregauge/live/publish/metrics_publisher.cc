// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/publish/metrics_publisher.h"

#include <fmt/format.h>

namespace moiregauge::internal {

tl::expected<std::unique_ptr<MetricsPublisher>, std::string> MetricsPublisher::open(const std::string& host, int port,
                                                                                    MetricsFacts facts) {
  std::unique_ptr<MetricsPublisher> publisher(new MetricsPublisher(std::move(facts)));
  auto server = serve_page(host, port, "/metrics", [self = publisher.get()] { return self->page(); });
  if (!server) return tl::unexpected(server.error());
  const bool is_ipv6 = host.find(':') != std::string::npos;
  publisher->address_ = fmt::format("http://{}:{}/metrics", is_ipv6 ? "[" + host + "]" : host, (*server)->port());
  publisher->server_ = std::move(*server);
  return publisher;
}

void MetricsPublisher::start(const LiveRun& run) {
  const std::lock_guard lock(mutex_);
  page_.run = run;
  page_.rows.clear();
}

void MetricsPublisher::put(const PublishedFrame& frame) {
  const std::lock_guard lock(mutex_);
  page_.health = frame.health;
  page_.utc_ns = frame.utc_ns;
  if (frame.rows.empty()) return;
  page_.rows.clear();
  for (const Sample& row : frame.rows) page_.rows.push_back(outlet_row(frame, row));
}

std::pair<std::string, std::string> MetricsPublisher::state() const { return {"metrics", address_}; }

std::string MetricsPublisher::page() const {
  MetricsPage copy;
  {
    const std::lock_guard lock(mutex_);
    copy = page_;
  }
  if (facts_.alarms) copy.alarms = facts_.alarms();
  if (facts_.lost_rows) copy.lost_rows = facts_.lost_rows();
  return metrics_text(copy);
}

}  // namespace moiregauge::internal
