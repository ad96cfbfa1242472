// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/api/server_state.h"

#include <charconv>
#include <utility>

namespace moiregauge::internal {

ServerState::ServerState(ConfinedFolder shown, std::function<void(std::string)> publish_event, int jobs_at_once)
    : folder(std::move(shown)),
      entries(folder.root()),
      uploads(folder),
      publish(std::move(publish_event)),
      queue({.folder = folder.root(), .at_once = jobs_at_once, .publish = publish}) {}

PathRules ServerState::path_rules() const {
  return {[this](std::string_view path) { return folder.existing(path).has_value(); },
          [this](std::string_view path) { return folder.creatable(path).has_value(); }};
}

Answer json_text_answer(int status, std::string json) {
  Answer answer;
  answer.status = status;
  answer.body = std::move(json);
  return answer;
}

std::string without_root(const ServerState& state, std::string_view message) {
  const std::string prefix = state.folder.root() + "/";
  std::string out(message);
  for (std::size_t at = 0; (at = out.find(prefix, at)) != std::string::npos;) out.erase(at, prefix.size());
  return out;
}

Answer no_such_path() { return error_answer(404, "nothing is there: the path: choose an entry of the folder"); }

long whole_parameter(const RequestHead& head, std::string_view name, long otherwise, long highest) {
  const std::string_view text = head.parameter(name);
  if (text.empty()) return otherwise;
  long value = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() && value >= 0 && value <= highest ? value : -1;
}

}  // namespace moiregauge::internal
