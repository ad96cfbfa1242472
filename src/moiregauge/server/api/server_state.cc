// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/api/server_state.h"

#include <charconv>

namespace moiregauge::internal {

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
