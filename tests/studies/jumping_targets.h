// SPDX-License-Identifier: Apache-2.0
// A sheet full of equal targets that jump at random, each within its own cell, in front of a moving camera.
#pragma once

#include "common/simulated_run.h"

namespace moiregauge::internal::study {

struct JumpKind {
  Pattern pattern = Pattern::kGrid;
  double pitch_mm = 5.0;  // mm; a pixel is 0.345 mm
  int pitches = 4;        // width of a grating
  double noise = 1.5;     // grey levels, standard deviation
  double psf_px = 0.7;    // px, sigma
  double covered = 0.0;   // share of the targets that are covered in some frames, by 30 to 100 % of their width
};

inline constexpr long kJumps = 20;  // frames after the reference frame
// Returns draw `number` of such a scenario.
[[nodiscard]] simulator::Scenario jumping_targets(const JumpKind& kind, int number);

}  // namespace moiregauge::internal::study
