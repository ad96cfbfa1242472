// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/live/outlet_options.h"

#include <fmt/format.h>

#include "moiregauge/app/live/recording_video.h"
#include "moiregauge/base/duration_text.h"

namespace moiregauge::internal::cli {
namespace {

constexpr double kMaxRecord_s = 3600.0;  // the frames before an alarm are kept in memory

// Reads a time above zero.
tl::expected<std::optional<double>, UsageError> time_of(const char* option, const std::string& text) {
  if (text.empty()) return std::nullopt;
  const auto read = long_duration_s(text);
  if (!read) return usage(fmt::format("the time cannot be read: {} {}: {}", option, text, read.error()));
  if (!(*read > 0.0 && *read <= kMaxRecord_s))
    return usage(fmt::format("the time is out of range: {} {}: give more than 0 s and at most 1 h", option, text));
  return *read;
}

}  // namespace

void add_outlet_options(CLI::App& command, OutletTexts& texts) {
  command
      .add_option("--publish", texts.publish,
                  "sends rows to mqtt://HOST/TOPIC, influx:FILE or influx+http://...; repeatable")
      ->type_name("ADDRESS")
      ->allow_extra_args(false);
  command.add_option("--listen", texts.listen, "serves /metrics for Prometheus on this computer, e.g. 127.0.0.1:9464")
      ->type_name("[HOST:]PORT");
  command.add_option("--alarm", texts.alarms, "raises an alarm, e.g. 'T1.dy > 2 mm for 0.5 s'; repeatable")
      ->type_name("RULE")
      ->allow_extra_args(false);
  command.add_option("--record", texts.record, "keeps the time before and after an alarm as video, e.g. 10s [nothing]")
      ->type_name("TIME");
  command
      .add_option("--record-full", texts.record_full,
                  "time between whole frames in it; others show the markers only [10s]")
      ->type_name("TIME");
  command.add_option("--mqtt-ca", texts.mqtt_ca, "certificates that prove an mqtts broker, PEM [the system's]")
      ->type_name("FILE");
}

tl::expected<Publishers, UsageError> open_outlets(const OutletTexts& texts, const std::string& folder,
                                                  AlarmListener& display) {
  PublishArgs args;
  const auto record = time_of("--record", texts.record), full = time_of("--record-full", texts.record_full);
  if (!record) return tl::unexpected(record.error());
  if (!full) return tl::unexpected(full.error());
  if (*full && !*record)
    return usage("--record-full applies to recordings only: live: add --record, e.g. --record 10s");
  args.publish = texts.publish;
  args.alarms = texts.alarms;
  args.listen = texts.listen;
  args.record_s = *record;
  args.full_frame_every_s = full->value_or(args.full_frame_every_s);
  args.mqtt_ca = texts.mqtt_ca;
  args.folder = folder + "-alarms";
  args.make_writer = recording_videos(args.folder);
  args.listeners = {&display};
  auto opened = open_publishers(args);
  if (!opened) return usage(opened.error());
  return std::move(*opened);
}

}  // namespace moiregauge::internal::cli
