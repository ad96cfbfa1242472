// SPDX-License-Identifier: Apache-2.0
// Twelve kinds of footage on which the stated uncertainty is held against the truth. In every run the truth is drawn
// anew from what the instrument is told: places, turns, heights and print scales as wide as [known_to], a given camera
// as wide as its stated u, an unknown one's centre and tangential distortion as wide as the instrument's prior. A site
// said to be exact is told so by a small [known_to].
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/simulated_run.h"

namespace moiregauge::internal::study {

struct TrustScenario {
  std::string name;
  std::string what;  // in words, for the table
  simulator::Scenario scenario;
  bool lens_known = false;
  double depth_mm = 0.0;  // standard deviation of a target's height that the site does not state
};

[[nodiscard]] const std::vector<TrustScenario>& trust_scenarios();

struct DrawnRun {
  simulator::Scenario scenario;
  test::RunPlan plan;
};
// Run `number` of it: another truth, other poses, another noise.
[[nodiscard]] DrawnRun drawn_run(const TrustScenario& kind, int number);

}  // namespace moiregauge::internal::study
