// SPDX-License-Identifier: Apache-2.0
// All values of a scenario by name, for files and --set.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "moiregauge/simulator/scenario/scenario.h"

namespace moiregauge::internal::simulator {

struct Setting {
  std::string name;                             // "lens.k1", "marker.mid.dy.scale"
  std::string kind;                             // "a number", for messages
  std::function<bool(const std::string&)> set;  // returns false if the text is not of this kind
};

// Returns the settings of a scenario. They write to `scenario` and must not outlive it.
[[nodiscard]] std::vector<Setting> settings_of(Scenario& scenario);

// Returns the first contradiction in a scenario as a message for the user; empty if there is none.
[[nodiscard]] std::optional<std::string> problem_with(const Scenario& scenario);

}  // namespace moiregauge::internal::simulator
