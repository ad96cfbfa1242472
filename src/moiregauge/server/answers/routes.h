// SPDX-License-Identifier: Apache-2.0
// Table of the server's addresses.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "moiregauge/server/api/server_state.h"

namespace moiregauge::internal {

struct Route {
  HttpMethod method;
  std::string_view path;  // '*' is one segment of letters and digits
  Answer (*answer)(ServerState& state, const Request& request);
  std::int64_t max_body = 0;   // bytes
  bool has_json_body = false;  // a POST with application/json
};

[[nodiscard]] std::span<const Route> routes();

// Returns the row of a request, or null. `is_other_method`: the address exists for the other method.
[[nodiscard]] const Route* find_route(HttpMethod method, std::string_view path, bool& is_other_method);

// Returns the part of a path that matches '*' of its row.
[[nodiscard]] std::string_view segment_of(std::string_view pattern, std::string_view path);

}  // namespace moiregauge::internal
