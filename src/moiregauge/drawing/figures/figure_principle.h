// SPDX-License-Identifier: Apache-2.0
// Draws figure 2: a small movement of a grating becomes a large movement of its moiré fringe, and a phase.
#pragma once

#include "moiregauge/drawing/surface/canvas.h"

namespace moiregauge::internal::figure {

// A grating of `pitch_px`, shifted by `moved_px` and sampled every `sampling_pitch_px` pixels.
struct PrincipleFigure {
  double pitch_px = 11.0;
  int sampling_pitch_px = 10;
  double moved_px = 2.0;
  int width_px = 220;
};

[[nodiscard]] Figure principle_of_sampling_moire(const PrincipleFigure& contents);

}  // namespace moiregauge::internal::figure
