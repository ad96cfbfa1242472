// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/run_dir/run_json_reader.h"

#include <nlohmann/json.hpp>

namespace moiregauge::internal {

std::string input_sha256_of_run(std::istream& run_json) {
  const auto json = nlohmann::json::parse(run_json, nullptr, false);
  if (json.is_discarded() || !json.contains("input") || !json["input"].contains("sha256")) return {};
  const auto& sha256 = json["input"]["sha256"];
  return sha256.is_string() ? sha256.get<std::string>() : std::string{};
}

}  // namespace moiregauge::internal
