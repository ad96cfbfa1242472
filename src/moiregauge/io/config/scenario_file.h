// SPDX-License-Identifier: Apache-2.0
// Reads simulator scenarios from TOML files, and single values by name (docs/cli/simulate.md).
#pragma once

#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/simulator/scenario/scenario.h"

namespace moiregauge::internal {

// Returns the scenario. Fails with all mistakes, each as "file:line:column: what is wrong".
[[nodiscard]] tl::expected<simulator::Scenario, std::vector<std::string>> read_scenario(const std::string& path);
[[nodiscard]] tl::expected<simulator::Scenario, std::vector<std::string>> parse_scenario(const std::string& text,
                                                                                         const std::string& path);

// Applies a setting such as "lens.k1=-0.0225". Fails with the problem and the nearest known key.
[[nodiscard]] tl::expected<void, std::string> apply_setting(simulator::Scenario& scenario,
                                                            const std::string& assignment);

}  // namespace moiregauge::internal
