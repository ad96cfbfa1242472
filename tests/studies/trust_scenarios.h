// SPDX-License-Identifier: Apache-2.0
// Twelve kinds of footage for the comparison of the stated uncertainty with the truth. Each run draws its truth from
// the uncertainties known to the instrument:
//     positions, rotations, heights and print scales: [known_to], small for an exact site
//     a known camera: its stated u
//     an unknown camera: the instrument's priors of principal point and tangential distortion
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/simulated_run.h"

namespace moiregauge::internal::study {

struct TrustScenario {
  std::string name;
  std::string what;  // description for the table
  simulator::Scenario scenario;
  bool lens_known = false;
  double depth_mm = 0.0;  // mm, standard deviation of the target's height, which the site does not state
};

[[nodiscard]] const std::vector<TrustScenario>& trust_scenarios();

struct DrawnRun {
  simulator::Scenario scenario;
  test::RunPlan plan;
};
// Returns run `number` with its own truth, poses and noise.
[[nodiscard]] DrawnRun drawn_run(const TrustScenario& kind, int number);

}  // namespace moiregauge::internal::study
