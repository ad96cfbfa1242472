// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <nlohmann/json.hpp>

#include "moiregauge/server/answers/answers.h"
#include "moiregauge/server/api/json_body.h"
#include "moiregauge/server/folder/run_movement.h"

namespace moiregauge::internal {
namespace {

using BatchJson = nlohmann::ordered_json;

BatchJson finite(double value) { return std::isfinite(value) && value >= 0.0 ? BatchJson(value) : BatchJson(nullptr); }

BatchJson value_at(const BatchJson& json, const char* key) {
  return json.is_object() && json.contains(key) && json[key].is_number() ? json[key] : BatchJson(nullptr);
}

// Returns the lowest named frequency of an axis.
BatchJson first_peak(const BatchJson& target, const char* axis) {
  const auto path = nlohmann::json_pointer<std::string>(std::string("/peaks/") + axis + "/0/frequency_hz");
  return target.contains(path) ? target[path] : BatchJson(nullptr);
}

BatchJson target_row(const BatchJson& target, const Movements& movements) {
  const std::string name = target.is_object() ? target.value("name", std::string()) : std::string();
  const auto found = movements.find(name);
  const MarkerMovement movement = found == movements.end() ? MarkerMovement{} : found->second;
  return {{"name", name},
          {"frames", value_at(target, "frames")},
          {"ok", value_at(target, "ok")},
          {"peak_to_peak_mm", {{"x", finite(movement.dx_mm())}, {"y", finite(movement.dy_mm())}}},
          {"u_mm", {{"x", value_at(target, "u_dx_mm")}, {"y", value_at(target, "u_dy_mm")}}},
          {"f1_hz", {{"x", first_peak(target, "x")}, {"y", first_peak(target, "y")}}}};
}

BatchJson run_row(const ServerState& state, const Entry& entry) {
  BatchJson row{
      {"run", entry.path}, {"name", std::filesystem::path(entry.path).filename().string()}, {"state", entry.state}};
  row["exit_code"] = entry.exit_code ? BatchJson(*entry.exit_code) : BatchJson(nullptr);
  row["targets"] = BatchJson::array();
  const auto file = state.folder.existing(entry.path + "/run.json");
  const auto samples = state.folder.existing(entry.path + "/displacement.csv");
  if (!file) return row;
  std::ifstream in(*file, std::ios::binary);
  const BatchJson json = BatchJson::parse(in, nullptr, false);
  const Movements movements = samples ? movements_of(*samples) : Movements{};
  if (!json.is_object() || !json.contains("targets") || !json["targets"].is_array()) return row;
  for (const BatchJson& target : json["targets"]) row["targets"].push_back(target_row(target, movements));
  return row;
}

}  // namespace

Answer answer_batch(ServerState& state, const Request& request) {
  const std::string_view folder = request.head.parameter("folder");
  if (!folder.empty() && !state.folder.existing(folder)) return no_such_path();
  const std::string prefix = folder.empty() ? std::string() : std::string(folder) + "/";
  BatchJson rows = BatchJson::array();
  for (const Entry& entry : state.entries.read()) {
    if (entry.kind == EntryKind::kRun && entry.path.starts_with(prefix)) rows.push_back(run_row(state, entry));
  }
  return json_text_answer(200, json_answer_text({{"rows", std::move(rows)}}));
}

}  // namespace moiregauge::internal
