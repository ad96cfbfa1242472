// SPDX-License-Identifier: Apache-2.0
// A sheet full of like prints that jump about, each within its own place, before a moving camera.
#pragma once

#include "common/simulated_run.h"

namespace moiregauge::internal::study {

struct JumpKind {
  Pattern pattern = Pattern::kGrid;
  double pitch_mm = 5.0;  // 0.345 mm are a pixel
  int pitches = 4;        // across a print
  double noise = 1.5;     // grey levels
  double psf_px = 0.7;
  double covered = 0.0;  // share of the targets that something lies over in some frames, a third to all of their width
};

inline constexpr long kJumps = 20;  // frames after the reference frame
[[nodiscard]] simulator::Scenario jumping_targets(const JumpKind& kind, int number);

}  // namespace moiregauge::internal::study
