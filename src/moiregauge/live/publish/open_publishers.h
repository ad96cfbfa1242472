// SPDX-License-Identifier: Apache-2.0
// Opens the outlets of a live run by their options.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/live/publisher.h"
#include "moiregauge/live/record/alarm_recorder.h"
#include "moiregauge/run/frame_sink.h"

namespace moiregauge::internal {

struct PublishArgs {
  // --publish: mqtt://..., mqtts://..., influx:FILE, influx+http://... or influx+https://...
  std::vector<std::string> publish;
  std::vector<std::string> alarms;        // --alarm
  std::string listen;                     // --listen [HOST:]PORT
  std::optional<double> record_s;         // --record, s before and after an alarm
  double full_frame_every_s = 10.0;       // --record-full, s between full frames in recordings
  std::string mqtt_ca;                    // --mqtt-ca FILE
  std::string folder;                     // for alarms.csv; empty: it is not written
  MakeRecordingWriter make_writer;        // required by record_s
  std::vector<AlarmListener*> listeners;  // further receivers of alarms, which must outlive the publishers
};

struct Publishers {
  std::vector<std::unique_ptr<Publisher>> all;
  // Null without --record. Call it for each frame before the publishers get it, and destroy it after them.
  std::unique_ptr<AlarmRecorder> recorder;

  Publishers() = default;
  Publishers(const Publishers&) = delete;
  Publishers& operator=(const Publishers&) = delete;
  Publishers(Publishers&&) = default;
  Publishers& operator=(Publishers&&) = delete;
  ~Publishers() { all.clear(); }
};

// Opens all outlets. Nothing is sent before the run starts. The passwords come from the environment:
// MOIREGAUGE_PASSWORD (MQTT) and MOIREGAUGE_TOKEN (InfluxDB).
// Fails with "what happened: where: what to do": a wrong address, rule or port, --record without --alarm.
[[nodiscard]] tl::expected<Publishers, std::string> open_publishers(const PublishArgs& args);

}  // namespace moiregauge::internal
