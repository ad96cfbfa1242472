// SPDX-License-Identifier: Apache-2.0
// A scenario by name or file, with the user's changes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/simulator/scenario/scenario.h"

namespace moiregauge::internal {

struct ScenarioArgs {
  std::string scenario;               // built-in name, or a TOML file
  std::vector<std::string> settings;  // "lens.k1=-0.02"
  std::optional<std::uint64_t> seed;
  std::optional<long> frames;
};

// Fails (error line without `error: `): an unknown name, or mistakes in file, settings or numbers.
[[nodiscard]] tl::expected<simulator::Scenario, std::string> load_scenario(const ScenarioArgs& args);

}  // namespace moiregauge::internal
