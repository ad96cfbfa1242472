// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/api/job_request.h"

#include <algorithm>
#include <utility>

#include <nlohmann/json.hpp>

namespace moiregauge::internal {
namespace {

// Reads a text and the list of arguments, and nothing else.
tl::expected<JobBody, std::string> read_words(const nlohmann::json& json, const char* first) {
  const auto is_text = [](const nlohmann::json& value) { return value.is_string(); };
  const bool is_complete = json.is_object() && json.size() == 2 && json.contains(first) && json[first].is_string() &&
                           json.contains("arguments") && json["arguments"].is_array() &&
                           std::ranges::all_of(json["arguments"], is_text);
  if (!is_complete)
    return tl::unexpected(std::string("the body is incomplete: the request: send ") + first +
                          " and arguments, a list of texts");
  return JobBody{json[first].get<std::string>(), json["arguments"].get<std::vector<std::string>>()};
}

}  // namespace

tl::expected<JobBody, std::string> job_body(const nlohmann::json& json) {
  auto body = read_words(json, "action");
  if (body && body->action == "live")
    return tl::unexpected(std::string("the action is unknown: the request: live sources have their own address"));
  return body;
}

tl::expected<JobBody, std::string> live_body(const nlohmann::json& json) {
  auto body = read_words(json, "source");
  if (!body) return body;
  body->arguments.insert(body->arguments.begin(), std::exchange(body->action, "live"));
  return body;
}

}  // namespace moiregauge::internal
