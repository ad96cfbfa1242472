// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/publish/alarm_publisher.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <system_error>

#include <fmt/format.h>

#include "moiregauge/base/csv_field.h"

namespace moiregauge::internal {
namespace {

constexpr std::size_t kNoMarker = std::numeric_limits<std::size_t>::max();

}  // namespace

AlarmPublisher::AlarmPublisher(const std::vector<AlarmRule>& rules, std::string log,
                               std::vector<AlarmListener*> listeners)
    : states_(rules.begin(), rules.end()),
      markers_(rules.size(), kNoMarker),
      log_(std::move(log)),
      listeners_(std::move(listeners)) {}

void AlarmPublisher::start(const LiveRun& run) {
  const std::lock_guard lock(mutex_);
  is_started_ = true;
  for (std::size_t i = 0; i < states_.size(); ++i) {
    markers_[i] = kNoMarker;
    for (const std::size_t target : run.targets) {
      if (run.markers[target] == states_[i].rule().marker) markers_[i] = target;
    }
  }
}

void AlarmPublisher::put(const PublishedFrame& frame) {
  std::vector<AlarmEvent> events;
  {
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 0; i < states_.size(); ++i) {
      const auto row = std::find_if(frame.rows.begin(), frame.rows.end(),
                                    [&](const Sample& sample) { return sample.marker == markers_[i]; });
      if (row == frame.rows.end() || row->status != Status::kOk) continue;
      const AlarmRule& rule = states_[i].rule();
      const double value_mm = rule.is_y ? row->displacement.y : row->displacement.x;
      const AlarmChange change = states_[i].step(frame.time_s, value_mm);
      if (change == AlarmChange::kNone) continue;
      events.push_back(
          {rule.text, rule.marker, change == AlarmChange::kRaised, frame.frame, frame.time_s, frame.utc_ns, value_mm});
    }
  }
  for (const AlarmEvent& event : events) {
    log(event);
    for (AlarmListener* listener : listeners_) listener->alarm(event);
  }
}

// A full disk loses lines of this log only. The alarm itself does not depend on it.
void AlarmPublisher::log(const AlarmEvent& event) const {
  if (log_.empty()) return;
  std::error_code ignored;
  std::filesystem::create_directories(std::filesystem::path(log_).parent_path(), ignored);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(log_.c_str(), "a"), &std::fclose);
  if (file == nullptr) return;
  std::string line = std::ftell(file.get()) == 0 ? kAlarmLogHeader : "";
  line += fmt::format("{},{},{:.6f},{},{},{:.6f}\n", event.utc_ns, event.frame, event.time_s,
                      event.is_raised ? "raised" : "cleared", csv_field(event.rule), event.value_mm);
  std::fwrite(line.data(), 1, line.size(), file.get());
}

std::pair<std::string, std::string> AlarmPublisher::state() const {
  const std::lock_guard lock(mutex_);
  std::string text;
  for (std::size_t i = 0; i < states_.size(); ++i) {
    const AlarmRule& rule = states_[i].rule();
    const bool has_no_target = is_started_ && markers_[i] == kNoMarker;
    if (!states_[i].is_raised() && !has_no_target) continue;
    text += text.empty() ? "" : ", ";
    text += has_no_target ? fmt::format("no target '{}'", rule.marker) : rule.text;
  }
  return {"alarm", text};
}

std::vector<std::pair<std::string, bool>> AlarmPublisher::all() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::pair<std::string, bool>> rules;
  for (const AlarmState& state : states_) rules.emplace_back(state.rule().text, state.is_raised());
  return rules;
}

}  // namespace moiregauge::internal
