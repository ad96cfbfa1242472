// SPDX-License-Identifier: Apache-2.0
// Writes rows, alarms and the run's condition in the formats of outlets. Numbers have a decimal point in every locale.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "moiregauge/live/row_block.h"

namespace moiregauge::internal {

// Returns one JSON object with arrays, in the order of the rows:
// {"source":..,"utc_ns":..,"frame":[..],"time_s":[..],"marker":[..],"dx_mm":[..],"dy_mm":[..],"u_dx_mm":[..],
// "u_dy_mm":[..],"status":[..]}. A value that was not measured is null.
[[nodiscard]] std::string rows_json(const LiveRun& run, const RowBlock& block);
// Returns {"rule":..,"marker":..,"state":"raised"|"cleared","frame":..,"time_s":..,"utc_ns":..,"value_mm":..}.
[[nodiscard]] std::string alarm_json(const AlarmEvent& event);
// Returns the run's condition as one JSON object.
[[nodiscard]] std::string health_json(const RowBlock& block);

// Returns lines of InfluxDB's line protocol, measurements `moiregauge` (one line per row) and `moiregauge_alarm`. A
// value that was not measured has no field, because the protocol has no NaN.
[[nodiscard]] std::string influx_lines(const LiveRun& run, const RowBlock& block);

// Facts for Prometheus.
struct MetricsPage {
  LiveRun run;
  std::vector<OutletRow> rows;  // rows of the newest frame that has any
  LiveHealth health;
  std::int64_t utc_ns = 0;                              // UTC of the newest frame
  std::vector<std::pair<std::string, bool>> alarms;     // rule; true if raised
  std::vector<std::pair<std::string, long>> lost_rows;  // by outlet
};
// Returns the page in Prometheus's text format 0.0.4.
[[nodiscard]] std::string metrics_text(const MetricsPage& page);

}  // namespace moiregauge::internal
