// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/live/live_display.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "moiregauge/app/live/utc_time.h"
#include "moiregauge/cli/common/terminal_text.h"
#include "moiregauge/live/health_text.h"
#include "moiregauge/live/publish/block_text.h"

namespace moiregauge::internal::cli {
namespace {

constexpr std::chrono::seconds kShowEvery{1};
constexpr std::size_t kTargetsOnLine = 3;  // on the line of a terminal
constexpr std::size_t kMaxAlarms = 100;    // that wait for a stopped terminal; alarms.csv has all

nlohmann::ordered_json json_number(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

std::string clock_text(double time_s) {
  if (std::isnan(time_s)) return "live";
  constexpr long kPerMinute = 60, kPerHour = 3600;
  const long s = std::lround(time_s);
  return fmt::format("live {}:{:02}:{:02}", s / kPerHour, s % kPerHour / kPerMinute, s % kPerMinute);
}

std::string target_text(const LiveRun& run, const Sample& sample) {
  const std::string& name = run.markers[sample.marker];
  if (std::isnan(sample.displacement.x) && std::isnan(sample.displacement.y))
    return fmt::format("  {} {}", name, word_for(sample.status));
  return fmt::format("  {} {:+.4f} {:+.4f} mm (u {:.4f} {:.4f}){}{}", name, sample.displacement.x,
                     sample.displacement.y, sample.u.x, sample.u.y, sample.status == Status::kOk ? "" : " ",
                     sample.status == Status::kOk ? "" : word_for(sample.status));
}

}  // namespace

std::string live_line(const LiveRun& run, const PublishedFrame& frame) {
  const LiveHealth& health = frame.health;
  std::string line =
      fmt::format("{}  {:.1f} frames/s, {}, latency {:.0f} ms (p99 {:.0f})", clock_text(frame.time_s),
                  health.frames_per_s, lost_text(health.lost), health.latency_p50_ms, health.latency_p99_ms);
  for (std::size_t k = 0; k < std::min(kTargetsOnLine, frame.rows.size()); ++k) line += target_text(run, frame.rows[k]);
  if (frame.rows.empty()) line += "  " + (frame.problem.empty() ? "no reference frame yet" : frame.problem);
  for (const std::string& hint : health_hints(health)) line += "; " + hint;
  return line;
}

std::string live_json_line(const LiveRun& run, const PublishedFrame& frame) {
  nlohmann::ordered_json json;
  json["type"] = "frame";
  json["frame"] = frame.frame;
  json["time_s"] = json_number(frame.time_s);
  json["utc"] = text_of_utc(frame.utc_ns);
  json["rows"] = nlohmann::ordered_json::array();
  for (const Sample& sample : frame.rows)
    json["rows"].push_back({{"marker", run.markers[sample.marker]},
                            {"dx_mm", json_number(sample.displacement.x)},
                            {"dy_mm", json_number(sample.displacement.y)},
                            {"u_dx_mm", json_number(sample.u.x)},
                            {"u_dy_mm", json_number(sample.u.y)},
                            {"status", word_for(sample.status)}});
  const LiveHealth& health = frame.health;
  json["frames"] = health.frames;
  json["lost"] = {{"queue_full", health.lost.queue_full},
                  {"incomplete", health.lost.incomplete},
                  {"in_camera", health.lost.in_camera},
                  {"starting", health.lost.starting}};
  json["queued"] = health.queued;
  json["scenes"] = health.scenes;
  json["frames_per_s"] = json_number(health.frames_per_s);
  json["latency_ms"] = {{"p50", json_number(health.latency_p50_ms)}, {"p99", json_number(health.latency_p99_ms)}};
  json["clipped"] = json_number(health.clipped);
  json["modulation"] = json_number(health.modulation);
  json["problem"] = frame.problem;
  json["hints"] = health_hints(health);
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::string alarm_line(const AlarmEvent& event) {
  return fmt::format("alarm {}: {} ({:.4f} mm in frame {}, {:.2f} s)", event.is_raised ? "raised" : "cleared",
                     event.rule, event.value_mm, event.frame, event.time_s);
}

LiveDisplay::LiveDisplay(LiveOutput output)
    : output_(output == LiveOutput::kLine && ::isatty(STDERR_FILENO) != 1 ? LiveOutput::kNothing : output),
      shows_alarms_(output != LiveOutput::kNothing) {
  if (shows_alarms_) thread_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
}

void LiveDisplay::start(const LiveRun& run) {
  const std::lock_guard lock(mutex_);
  run_ = run;
}

void LiveDisplay::put(const PublishedFrame& frame) {
  if (output_ == LiveOutput::kNothing) return;
  const std::lock_guard lock(mutex_);
  newest_ = frame;
}

void LiveDisplay::finish(double /*seconds*/) {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

void LiveDisplay::alarm(const AlarmEvent& event) {
  if (!shows_alarms_) return;
  const std::lock_guard lock(mutex_);
  if (alarms_.size() < kMaxAlarms) alarms_.push_back(event);
  stopped_.notify_all();
}

void LiveDisplay::show_alarms(const std::vector<AlarmEvent>& events) {
  for (const AlarmEvent& event : events) {
    if (output_ == LiveOutput::kJsonLines) {
      print_out("{\"type\":\"alarm\"," + alarm_json(event).substr(1) + "\n");
      std::fflush(stdout);
      continue;
    }
    if (is_shown_) fmt::print(stderr, "\r\x1b[K");
    print_note(alarm_line(event) + "\n");
  }
}

void LiveDisplay::show(const LiveRun& run, const PublishedFrame& frame) {
  if (output_ == LiveOutput::kJsonLines) {
    print_out(live_json_line(run, frame) + "\n");
    std::fflush(stdout);
    return;
  }
  is_shown_ = true;
  fmt::print(stderr, "\r\x1b[K");
  print_note(live_line(run, frame));
  std::fflush(stderr);
}

void LiveDisplay::work(const std::stop_token& stop) {
  bool is_last = false;
  while (!is_last) {
    std::optional<PublishedFrame> frame;
    std::vector<AlarmEvent> alarms;
    LiveRun run;
    {
      std::unique_lock lock(mutex_);
      stopped_.wait_for(lock, stop, kShowEvery, [this] { return !alarms_.empty(); });
      is_last = stop.stop_requested();
      frame = std::exchange(newest_, std::nullopt);
      alarms = std::exchange(alarms_, {});
      if (run_) run = *run_;
    }
    show_alarms(alarms);
    if (frame && output_ != LiveOutput::kNothing) show(run, *frame);
  }
  if (is_shown_) fmt::print(stderr, "\r\x1b[K");
}

}  // namespace moiregauge::internal::cli
