// SPDX-License-Identifier: Apache-2.0
// Every value of a scenario by name, so that files and --set speak of all of them in one way.
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
  std::function<bool(const std::string&)> set;  // false: not of this kind
};

// The settings of this scenario; they write into it and live no longer than it.
[[nodiscard]] std::vector<Setting> settings_of(Scenario& scenario);

// What makes no sense about it, in the user's words.
[[nodiscard]] std::optional<std::string> problem_with(const Scenario& scenario);

}  // namespace moiregauge::internal::simulator
