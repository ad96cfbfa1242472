// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/api/json_body.h"

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

namespace moiregauge::internal {
namespace {

constexpr int kMaxNesting = 16;

// Counts brackets outside strings.
bool is_nested_too_deeply(std::string_view text) {
  int depth = 0;
  bool is_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (is_string && c == '\\') {
      ++i;
    } else if (c == '"') {
      is_string = !is_string;
    } else if (!is_string && (c == '{' || c == '[')) {
      if (++depth > kMaxNesting) return true;
    } else if (!is_string && (c == '}' || c == ']')) {
      --depth;
    }
  }
  return false;
}

tl::unexpected<std::string> bad_body(const char* what) {
  return tl::unexpected(std::string(what) + ": the request: send one JSON object");
}

}  // namespace

tl::expected<nlohmann::json, std::string> parse_json_body(std::string_view text) {
  if (is_nested_too_deeply(text)) return bad_body("the JSON is nested too deeply");
  std::vector<std::set<std::string>> keys;
  bool has_repeated_key = false;
  const auto watch = [&](int, nlohmann::json::parse_event_t event, nlohmann::json& parsed) {
    using Event = nlohmann::json::parse_event_t;
    if (event == Event::object_start) keys.emplace_back();
    if (event == Event::object_end && !keys.empty()) keys.pop_back();
    if (event == Event::key && !keys.empty())
      has_repeated_key = has_repeated_key || !keys.back().insert(parsed.get<std::string>()).second;
    return true;
  };
  auto json = nlohmann::json::parse(text, watch, false);
  if (json.is_discarded()) return bad_body("the body is no valid JSON");
  if (!json.is_object()) return bad_body("the JSON is no object");
  if (has_repeated_key) return bad_body("a key of the JSON is repeated");
  return json;
}

std::string json_answer_text(const nlohmann::ordered_json& json) {
  const std::string plain = json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  std::string out;
  out.reserve(plain.size());
  for (const char c : plain) {
    if (c == '<')
      out += "\\u003c";  // occurs in strings only
    else
      out += c;
  }
  return out + "\n";
}

}  // namespace moiregauge::internal
