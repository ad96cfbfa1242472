// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/api/routes.h"

#include <algorithm>
#include <array>

#include "moiregauge/server/api/answers.h"

namespace moiregauge::internal {
namespace {

using enum HttpMethod;

constexpr std::int64_t kMaxJson = 256 << 10;  // bytes

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
