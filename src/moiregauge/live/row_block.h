// SPDX-License-Identifier: Apache-2.0
// Rows of about one second, the unit in which slow outlets send.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "moiregauge/displacement/sample.h"
#include "moiregauge/live/publisher.h"

namespace moiregauge::internal {

// One row of displacement.csv, with the host's time.
struct OutletRow {
  long frame = 0;
  double time_s = kNotMeasured;
  std::int64_t utc_ns = 0;
  std::size_t marker = 0;  // index into LiveRun::markers
  double dx_mm = kNotMeasured;
  double dy_mm = kNotMeasured;
  double u_dx_mm = kNotMeasured;
  double u_dy_mm = kNotMeasured;
  Status status = Status::kLost;
};

[[nodiscard]] inline OutletRow outlet_row(const PublishedFrame& frame, const Sample& sample) {
  return {frame.frame,           sample.time_s, frame.utc_ns, sample.marker, sample.displacement.x,
          sample.displacement.y, sample.u.x,    sample.u.y,   sample.status};
}

// A change of an alarm.
struct AlarmEvent {
  std::string rule;  // as typed
  std::string marker;
  bool is_raised = false;  // false: cleared
  long frame = 0;
  double time_s = kNotMeasured;
  std::int64_t utc_ns = 0;
  double value_mm = kNotMeasured;
};

// Receives changes of alarms on the measuring thread. It must not block.
class AlarmListener {
 public:
  virtual ~AlarmListener() = default;
  virtual void alarm(const AlarmEvent& event) = 0;
};

struct RowBlock {
  std::vector<OutletRow> rows;
  std::vector<AlarmEvent> alarms;
  LiveHealth health;        // after its last frame
  std::int64_t utc_ns = 0;  // UTC of its last frame
};

}  // namespace moiregauge::internal
