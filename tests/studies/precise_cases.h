// SPDX-License-Identifier: Apache-2.0
// Test cases of the method `precise`: scenario, values known to the instrument, requirement, number of runs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "moiregauge/simulator/simulator.h"
#include "moiregauge/units/frame_range.h"

namespace moiregauge::internal::study {

enum class Bound { kPhase, kFull };

struct PreciseCase {
  std::string name;
  std::string gate;  // requirement as text for the table
  simulator::Scenario scenario;
  Bound bound = Bound::kPhase;
  bool lens_known = false;
  bool heights_known = false;  // in long runs, the site states the heights, which are exact there, to 1 um
  std::optional<FrameRange> rest{};
  std::optional<double> readout_s{};  // s, value of --readout
  long frames = 60;                   // per long run, including the reference frame
  long step = 1;                      // uses every step-th frame of the scenario
  long coverage_frames = 8;           // per short run, including the reference frame
  long coverage_step = 6;             // as step, for short runs
  int runs = 10;                      // long runs, default of --runs
  int coverage_runs = 200;            // short runs, default of --coverage
};

[[nodiscard]] const std::vector<PreciseCase>& precise_cases();

// Returns the scenario with another seed of the noise, the camera poses and the true positions.
[[nodiscard]] simulator::Scenario redrawn(const simulator::Scenario& scenario, int seed);

// States all heights as zero, known to u_mm.
void state_heights(simulator::Scenario& scenario, double u_mm);

}  // namespace moiregauge::internal::study
