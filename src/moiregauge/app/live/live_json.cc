// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/live/live_json.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "moiregauge/version.h"

namespace moiregauge::internal {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

}  // namespace

std::string live_json(const LiveFacts& facts) {
  Json json;
  json["moiregauge"] = kVersion;
  json["schema"] = 1;
  json["source"] = facts.source;
  json["begin_utc"] = facts.begin_utc;
  json["end"] = facts.end;
  json["resumed_at"] = facts.resumed_at < 0 ? Json(nullptr) : Json(facts.resumed_at);
  json["settings"] = Json::object();
  for (const auto& [key, value] : facts.settings) json["settings"][key] = value;
  const LiveHealth& health = facts.health;
  json["frames"] = health.frames;
  json["rows"] = health.rows;
  json["ok_rows"] = health.ok_rows;
  json["lost_frames"] = {{"queue_full", health.lost.queue_full},
                         {"incomplete", health.lost.incomplete},
                         {"in_camera", health.lost.in_camera},
                         {"starting", health.lost.starting}};
  json["reconnects"] = health.lost.reconnects;
  json["scenes"] = health.scenes;
  json["latency_ms"] = {{"p50", number(health.latency_p50_ms)}, {"p99", number(health.latency_p99_ms)}};
  json["frames_per_s"] = number(health.frames_per_s);
  json["outlets"] = Json::array();
  for (const LiveFacts::Outlet& outlet : facts.outlets)
    json["outlets"].push_back({{"name", outlet.name}, {"state", outlet.state}, {"lost_rows", outlet.lost_rows}});
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace moiregauge::internal
