// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/publish/block_text.h"

#include <cmath>
#include <iterator>

#include <fmt/format.h>

namespace moiregauge::internal {
namespace {

using Out = std::back_insert_iterator<std::string>;

const std::string& marker_of(const LiveRun& run, std::size_t index) {
  static const std::string unknown = "?";
  return index < run.markers.size() ? run.markers[index] : unknown;
}

// Returns a JSON string. Bytes above 0x7f are UTF-8 already.
std::string json_text(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      out += {'\\', c};
    else if (static_cast<unsigned char>(c) < 0x20)
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    else
      out += c;
  }
  return out + "\"";
}

// The shortest text that reads back as the same number.
void number(Out out, double value) {
  if (std::isfinite(value))
    fmt::format_to(out, "{}", value);
  else
    fmt::format_to(out, "null");
}

template <typename Value>
void array(std::string& text, const char* key, const std::vector<OutletRow>& rows, Value value) {
  text += fmt::format(",\"{}\":[", key);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i > 0) text += ',';
    value(rows[i]);
  }
  text += ']';
}

// Returns a tag of the line protocol with its special characters escaped.
std::string tag(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == ',' || c == '=' || c == ' ' || c == '\\') out += '\\';
    out += static_cast<unsigned char>(c) < 0x20 ? '_' : c;
  }
  return out.empty() ? "_" : out;
}

// Returns a label's value for Prometheus.
std::string label(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (c == '\n')
      out += "\\n";
    else
      out += c;
  }
  return out;
}

std::string prometheus_number(double value) {
  if (std::isnan(value)) return "NaN";
  if (std::isinf(value)) return value > 0.0 ? "+Inf" : "-Inf";
  return fmt::format("{}", value);
}

void head(std::string& text, const char* name, const char* type, const char* help) {
  text += fmt::format("# HELP {} {}\n# TYPE {} {}\n", name, help, name, type);
}
void single(std::string& text, const char* name, const char* type, const char* help, double value) {
  head(text, name, type, help);
  text += fmt::format("{} {}\n", name, prometheus_number(value));
}

void row_metrics(std::string& text, const MetricsPage& page) {
  struct Gauge {
    const char* name;
    const char* help;
    double OutletRow::*x;
    double OutletRow::*y;
  };
  constexpr Gauge kGauges[] = {
      {"moiregauge_displacement_mm", "Displacement since the reference frame.", &OutletRow::dx_mm, &OutletRow::dy_mm},
      {"moiregauge_uncertainty_mm", "Standard uncertainty (k = 1) of the displacement.", &OutletRow::u_dx_mm,
       &OutletRow::u_dy_mm}};
  for (const Gauge& gauge : kGauges) {
    head(text, gauge.name, "gauge", gauge.help);
    for (const OutletRow& row : page.rows) {
      const std::string marker = label(marker_of(page.run, row.marker));
      text += fmt::format("{}{{marker=\"{}\",axis=\"x\"}} {}\n", gauge.name, marker, prometheus_number(row.*gauge.x));
      text += fmt::format("{}{{marker=\"{}\",axis=\"y\"}} {}\n", gauge.name, marker, prometheus_number(row.*gauge.y));
    }
  }
  head(text, "moiregauge_row_ok", "gauge", "1 if the newest row of the marker has the status ok.");
  for (const OutletRow& row : page.rows)
    text += fmt::format("moiregauge_row_ok{{marker=\"{}\",status=\"{}\"}} {}\n", label(marker_of(page.run, row.marker)),
                        word_for(row.status), row.status == Status::kOk ? 1 : 0);
}

void health_metrics(std::string& text, const MetricsPage& page) {
  const LiveHealth& health = page.health;
  single(text, "moiregauge_frames_total", "counter", "Frames measured.", static_cast<double>(health.frames));
  head(text, "moiregauge_frames_lost_total", "counter", "Frames that were not measured, by cause.");
  text += fmt::format("moiregauge_frames_lost_total{{cause=\"queue_full\"}} {}\n", health.lost.queue_full);
  text += fmt::format("moiregauge_frames_lost_total{{cause=\"incomplete\"}} {}\n", health.lost.incomplete);
  text += fmt::format("moiregauge_frames_lost_total{{cause=\"in_camera\"}} {}\n", health.lost.in_camera);
  text += fmt::format("moiregauge_frames_lost_total{{cause=\"starting\"}} {}\n", health.lost.starting);
  single(text, "moiregauge_reconnects_total", "counter", "Times the source was lost and found again.",
         static_cast<double>(health.lost.reconnects));
  single(text, "moiregauge_rows_total", "counter", "Rows published.", static_cast<double>(health.rows));
  single(text, "moiregauge_rows_ok_total", "counter", "Rows published with the status ok.",
         static_cast<double>(health.ok_rows));
  single(text, "moiregauge_scenes_total", "counter", "Scenes solved.", static_cast<double>(health.scenes));
  single(text, "moiregauge_queued_frames", "gauge", "Complete frames that wait in the source.", health.queued);
  single(text, "moiregauge_frame_rate_hz", "gauge", "Measured frames per second.", health.frames_per_s);
  head(text, "moiregauge_latency_seconds", "gauge", "Time from the complete frame to its rows, by quantile.");
  text += fmt::format("moiregauge_latency_seconds{{quantile=\"0.5\"}} {}\n",
                      prometheus_number(health.latency_p50_ms / 1e3));
  text += fmt::format("moiregauge_latency_seconds{{quantile=\"0.99\"}} {}\n",
                      prometheus_number(health.latency_p99_ms / 1e3));
  single(text, "moiregauge_clipped_ratio", "gauge", "Share of pixels at the ends of the range, worst marker.",
         health.clipped);
  single(text, "moiregauge_modulation_ratio", "gauge", "Modulation relative to the reference frame, worst marker.",
         health.modulation);
  single(text, "moiregauge_last_frame_timestamp_seconds", "gauge", "UTC of the newest frame.",
         static_cast<double>(page.utc_ns) * 1e-9);
}

}  // namespace

std::string rows_json(const LiveRun& run, const RowBlock& block) {
  std::string text = fmt::format("{{\"source\":{},\"utc_ns\":{}", json_text(run.source), block.utc_ns);
  const Out out(text);
  const std::vector<OutletRow>& rows = block.rows;
  array(text, "frame", rows, [&](const OutletRow& row) { fmt::format_to(out, "{}", row.frame); });
  array(text, "time_s", rows, [&](const OutletRow& row) { number(out, row.time_s); });
  array(text, "marker", rows, [&](const OutletRow& row) { text += json_text(marker_of(run, row.marker)); });
  array(text, "dx_mm", rows, [&](const OutletRow& row) { number(out, row.dx_mm); });
  array(text, "dy_mm", rows, [&](const OutletRow& row) { number(out, row.dy_mm); });
  array(text, "u_dx_mm", rows, [&](const OutletRow& row) { number(out, row.u_dx_mm); });
  array(text, "u_dy_mm", rows, [&](const OutletRow& row) { number(out, row.u_dy_mm); });
  array(text, "status", rows, [&](const OutletRow& row) { text += json_text(word_for(row.status)); });
  return text + "}";
}

std::string alarm_json(const AlarmEvent& event) {
  std::string text =
      fmt::format("{{\"rule\":{},\"marker\":{},\"state\":\"{}\",\"frame\":{},\"time_s\":", json_text(event.rule),
                  json_text(event.marker), event.is_raised ? "raised" : "cleared", event.frame);
  number(Out(text), event.time_s);
  text += fmt::format(",\"utc_ns\":{},\"value_mm\":", event.utc_ns);
  number(Out(text), event.value_mm);
  return text + "}";
}

std::string health_json(const RowBlock& block) {
  const LiveHealth& health = block.health;
  std::string text = fmt::format(
      "{{\"utc_ns\":{},\"frames\":{},\"lost\":{{\"queue_full\":{},\"incomplete\":{},\"in_camera\":{},"
      "\"starting\":{}}},\"reconnects\":{"
      "},"
      "\"rows\":{},\"ok_rows\":{},\"scenes\":{},\"queued\":{}",
      block.utc_ns, health.frames, health.lost.queue_full, health.lost.incomplete, health.lost.in_camera,
      health.lost.starting, health.lost.reconnects, health.rows, health.ok_rows, health.scenes, health.queued);
  const std::pair<const char*, double> numbers[] = {{"latency_p50_ms", health.latency_p50_ms},
                                                    {"latency_p99_ms", health.latency_p99_ms},
                                                    {"frames_per_s", health.frames_per_s},
                                                    {"clipped", health.clipped},
                                                    {"modulation", health.modulation}};
  for (const auto& [key, value] : numbers) {
    text += fmt::format(",\"{}\":", key);
    number(Out(text), value);
  }
  return text + "}";
}

std::string influx_lines(const LiveRun& run, const RowBlock& block) {
  std::string text;
  const std::string source = tag(run.source);
  for (const OutletRow& row : block.rows) {
    text += fmt::format("moiregauge,marker={},source={} ", tag(marker_of(run, row.marker)), source);
    const std::pair<const char*, double> fields[] = {{"dx_mm", row.dx_mm},
                                                     {"dy_mm", row.dy_mm},
                                                     {"u_dx_mm", row.u_dx_mm},
                                                     {"u_dy_mm", row.u_dy_mm},
                                                     {"time_s", row.time_s}};
    for (const auto& [key, value] : fields) {
      if (std::isfinite(value)) text += fmt::format("{}={},", key, value);
    }
    text += fmt::format("frame={}i,status=\"{}\" {}\n", row.frame, word_for(row.status), row.utc_ns);
  }
  for (const AlarmEvent& event : block.alarms) {
    text += fmt::format("moiregauge_alarm,marker={},rule={},source={} ", tag(event.marker), tag(event.rule), source);
    if (std::isfinite(event.value_mm)) text += fmt::format("value_mm={},", event.value_mm);
    text += fmt::format("raised={} {}\n", event.is_raised ? "true" : "false", event.utc_ns);
  }
  return text;
}

std::string metrics_text(const MetricsPage& page) {
  std::string text;
  row_metrics(text, page);
  health_metrics(text, page);
  head(text, "moiregauge_alarm", "gauge", "1 while the alarm is raised.");
  for (const auto& [rule, is_raised] : page.alarms)
    text += fmt::format("moiregauge_alarm{{rule=\"{}\"}} {}\n", label(rule), is_raised ? 1 : 0);
  head(text, "moiregauge_outlet_lost_rows_total", "counter", "Rows that an outlet lost, by outlet.");
  for (const auto& [outlet, rows] : page.lost_rows)
    text += fmt::format("moiregauge_outlet_lost_rows_total{{outlet=\"{}\"}} {}\n", label(outlet), rows);
  return text;
}

}  // namespace moiregauge::internal
