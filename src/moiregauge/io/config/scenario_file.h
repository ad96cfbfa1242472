// SPDX-License-Identifier: Apache-2.0
// A scenario of the simulator from a TOML file, and single values by name (docs/cli/simulate.md).
#pragma once

#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/simulator/scenario/scenario.h"

namespace moiregauge::internal {

// Everything the file says, or everything wrong with it, each "file:line:column: what is wrong".
[[nodiscard]] tl::expected<simulator::Scenario, std::vector<std::string>> read_scenario(const std::string& path);
[[nodiscard]] tl::expected<simulator::Scenario, std::vector<std::string>> parse_scenario(const std::string& text,
                                                                                         const std::string& path);

// "lens.k1=-0.0225"; the error says what is wrong and what may have been meant.
[[nodiscard]] tl::expected<void, std::string> apply_setting(simulator::Scenario& scenario,
                                                            const std::string& assignment);

}  // namespace moiregauge::internal
