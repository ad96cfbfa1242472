// SPDX-License-Identifier: Apache-2.0
// The cases by which `precise` is judged: what is recorded, what the instrument is told, what it may cost.
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
  std::string gate;  // in words, for the table
  simulator::Scenario scenario;
  Bound bound = Bound::kPhase;
  bool lens_known = false;
  std::optional<FrameRange> rest{};
  std::optional<double> readout_s{};  // as --readout gives it
  long frames = 60;                   // of a run, the reference frame among them
  long step = 1;                      // every step-th frame of the scenario
  long coverage_frames = 8;           // of a short run, likewise
  long coverage_step = 6;
  int runs = 10;  // unless --runs says otherwise
  int coverage_runs = 200;
};

[[nodiscard]] const std::vector<PreciseCase>& precise_cases();

// The scenario with another noise, other poses and other true places.
[[nodiscard]] simulator::Scenario drawn_anew(const simulator::Scenario& scenario, int seed);

}  // namespace moiregauge::internal::study
