// SPDX-License-Identifier: Apache-2.0
// Interface of the outlets of a live run: the growing table, MQTT, Prometheus, InfluxDB, alarms, the terminal.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "moiregauge/displacement/method.h"
#include "moiregauge/run/live_source.h"

namespace moiregauge::internal {

// Condition of the run after a frame.
struct LiveHealth {
  long frames = 0;   // frames measured since the start
  LostFrames lost;   // frames lost since the start
  int queued = 0;    // complete frames that wait in the source
  long rows = 0;     // rows published since the start
  long ok_rows = 0;  // those with status ok
  long scenes = 0;   // scenes solved since the start; 0: rows are not trusted yet
  // Over the last 1024 frames. NaN before the first.
  double latency_p50_ms = kNotMeasured;  // from the complete frame to its rows
  double latency_p99_ms = kNotMeasured;
  double frames_per_s = kNotMeasured;  // measured frames by the host's clock
  // Image of the markers in this frame, the worst marker each. NaN if no marker was read.
  double clipped = kNotMeasured;     // share of pixels at the ends of the range
  double modulation = kNotMeasured;  // amplitude of the gratings relative to the reference frame: light, focus, blur
};

// Samples of one frame.
struct PublishedFrame {
  long frame = 0;                         // number in the source
  double time_s = kNotMeasured;           // s since frame 0
  std::optional<std::int64_t> device_ns;  // camera's clock
  std::int64_t host_ns = 0;               // steady_clock when the frame was complete
  std::int64_t utc_ns = 0;                // system_clock when the frame was complete, ns since 1970
  // One per target in the site's order; empty before the reference frame. `displacement` and `u` are provisional, from
  // the scene now in force. NaN is "not measured".
  Samples rows;
  std::string problem;  // why the frame is not measured; empty if it is
  LiveHealth health;
};

// Facts about the run, known with its reference frame.
struct LiveRun {
  std::string source;                // SOURCE as typed
  std::vector<std::string> markers;  // names of all site markers; Sample::marker is an index into it
  std::vector<std::size_t> targets;  // markers that have rows, in the order of the rows
  long reference_frame = 0;
};

// The measuring thread calls start(), then put() once per frame. A publisher must not block it: slow outlets copy into a
// bounded queue of their own and work on their own thread.
class Publisher {
 public:
  virtual ~Publisher() = default;
  // Receives the run before the first frame with rows. A publisher must ignore frames without rows before that.
  virtual void start(const LiveRun& run) = 0;
  virtual void put(const PublishedFrame& frame) = 0;
  // Sends pending rows within at most `seconds`, then stops. No call comes after it.
  virtual void finish(double seconds) = 0;
  // Returns the number of rows lost by the bounded queue or an absent receiver. Any thread.
  [[nodiscard]] virtual long lost_rows() const { return 0; }
  // Returns the name and state for the user, e.g. {"mqtt", "connected"} or {"mqtt", "reconnecting"}. Any thread. Empty
  // state: nothing to say.
  [[nodiscard]] virtual std::pair<std::string, std::string> state() const { return {}; }
};

}  // namespace moiregauge::internal
