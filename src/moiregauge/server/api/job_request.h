// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <tl/expected.hpp>

namespace moiregauge::internal {

struct JobBody {
  std::string action;
  std::vector<std::string> arguments;
};

// Reads {"action", "arguments"}. Fails with "what: where: what to do".
[[nodiscard]] tl::expected<JobBody, std::string> job_body(const nlohmann::json& json);
// Reads {"source", "arguments"} as the action `live`.
[[nodiscard]] tl::expected<JobBody, std::string> live_body(const nlohmann::json& json);

}  // namespace moiregauge::internal
