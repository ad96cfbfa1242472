// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/answers/routes.h"

#include <algorithm>
#include <array>

#include "moiregauge/server/answers/answers.h"

namespace moiregauge::internal {
namespace {

using enum HttpMethod;

constexpr std::int64_t kMaxJson = 256 << 10;  // bytes
constexpr std::int64_t kMaxPiece = 16 << 20;  // bytes of an upload in one request

constexpr auto kRoutes = std::to_array<Route>({
    {kGet, "/", answer_page},
    {kGet, "/app.js", answer_script},
    {kGet, "/app.css", answer_style},
    {kGet, "/api/session", answer_session},
    {kGet, "/api/entries", answer_entries},
    {kGet, "/api/thumbnail", answer_thumbnail},
    {kGet, "/api/frame", answer_frame},
    {kPost, "/api/inspect", answer_inspect, kMaxJson, true},
    {kPost, "/api/site", answer_site, kMaxJson, true},
    {kGet, "/api/jobs", answer_jobs},
    {kPost, "/api/jobs", answer_new_job, kMaxJson, true},
    {kPost, "/api/jobs/*/cancel", answer_cancel, kMaxJson, true},
    {kPost, "/api/jobs/*/resume", answer_resume, kMaxJson, true},
    {kGet, "/api/events", answer_events},
    {kGet, "/api/cameras", answer_cameras},
    {kGet, "/api/live", answer_live},
    {kPost, "/api/live", answer_new_live, kMaxJson, true},
    {kPost, "/api/live/*/stop", answer_stop_live, kMaxJson, true},
    {kGet, "/api/live-frame", answer_live_frame},
    {kGet, "/api/run", answer_run},
    {kGet, "/api/series", answer_series},
    {kGet, "/api/run-frame", answer_run_frame},
    {kGet, "/api/run-markers", answer_run_markers},
    {kGet, "/api/file", answer_file},
    {kGet, "/api/batch", answer_batch},
    {kPost, "/api/ticket", answer_ticket, kMaxJson, true},
    {kGet, "/report/*", answer_report},
    {kGet, "/api/upload", answer_received},
    {kPost, "/api/upload", answer_upload, kMaxPiece},
});

bool is_segment(std::string_view text) {
  return !text.empty() && text.size() <= 32 && std::ranges::all_of(text, [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
  });
}

bool is_match(std::string_view pattern, std::string_view path) {
  return pattern == path || (pattern.find('*') != std::string_view::npos && is_segment(segment_of(pattern, path)));
}

}  // namespace

std::span<const Route> routes() { return kRoutes; }

std::string_view segment_of(std::string_view pattern, std::string_view path) {
  const std::size_t star = pattern.find('*');
  if (star == std::string_view::npos) return {};
  const std::string_view before = pattern.substr(0, star), after = pattern.substr(star + 1);
  if (path.size() < before.size() + after.size() || !path.starts_with(before) || !path.ends_with(after)) return {};
  return path.substr(before.size(), path.size() - before.size() - after.size());
}

const Route* find_route(HttpMethod method, std::string_view path, bool& is_other_method) {
  is_other_method = false;
  for (const Route& route : kRoutes) {
    if (!is_match(route.path, path)) continue;
    if (route.method == method) return &route;
    is_other_method = true;
  }
  return nullptr;
}

}  // namespace moiregauge::internal
