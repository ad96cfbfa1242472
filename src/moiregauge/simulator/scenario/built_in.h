// SPDX-License-Identifier: Apache-2.0
// The recordings that need no file: the rig of the paper and a small one, each with the paper's camera movements.
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

// The target's movement of the paper's section 3.2, mm: up 1 mm in 2 s, hold 2 s, up to 2 mm, hold, down to 1, hold,
// down to 0, hold; 16 s in all.
[[nodiscard]] Track paper_motion();

}  // namespace moiregauge::internal::simulator
