// SPDX-License-Identifier: Apache-2.0
// Built-in scenarios: the rig of the paper and a small one with several camera movements, a drone, and ink-jet
// gratings.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "moiregauge/simulator/scenario/scenario.h"

namespace moiregauge::internal::simulator {

struct BuiltIn {
  std::string_view name;
  std::string_view summary;
};

[[nodiscard]] const std::vector<BuiltIn>& built_in_scenarios();
[[nodiscard]] std::optional<Scenario> built_in(const std::string& name);

// Returns the target's movement of section 3.2 of the paper in mm. It rises to 1 mm in 2 s, holds for 2 s, and rises to
// 2 mm. It returns in the same steps and takes 16 s.
[[nodiscard]] Track paper_motion();

}  // namespace moiregauge::internal::simulator
