// SPDX-License-Identifier: Apache-2.0
// The methods of measuring, as a table: a method is a row.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "moiregauge/displacement/sample.h"
#include "moiregauge/observation/observe.h"

namespace moiregauge {

using Samples = std::vector<Sample>;  // by observation, then by target in the site's order

// Seed paper 2.1. Displacements stay wrapped within half a pitch, as published.
[[nodiscard]] Samples solve_conventional(const Reference& reference, const std::vector<Observation>& observations);

// Seed paper 2.2, with travel followed beyond half a pitch, and u.
[[nodiscard]] Samples solve_two_stage(const Reference& reference, const std::vector<Observation>& observations);

struct Method {
  std::string_view name;
  std::string_view summary;
  Observation (*observe)(const GreyPicture&, const Reference&, const Prediction&, PatchWorkspace&);
  Samples (*solve)(const Reference&, const std::vector<Observation>&);
  bool needs_circles = true;  // false: gratings are enough, the camera stands still
};

inline constexpr std::array kMethods{
    Method{"conventional", "sampling moire, camera assumed still (seed paper 2.1)", observe_conventional,
           solve_conventional, false},
    Method{"two-stage", "the seed paper: circle centres, then moire-refined centres (2.2)", observe_two_stage,
           solve_two_stage},
};
inline constexpr std::string_view kDefaultMethod = "two-stage";

[[nodiscard]] constexpr const Method* method_named(std::string_view name) {
  for (const Method& method : kMethods) {
    if (method.name == name) return &method;
  }
  return nullptr;
}

}  // namespace moiregauge
