// SPDX-License-Identifier: Apache-2.0
// Figure 2: how a small movement of a grating becomes a large one of its moire fringe, and that a phase.
#pragma once

#include "moiregauge/drawing/surface/canvas.h"

namespace moiregauge::internal::figure {

// A grating of `pitch_px`, moved by `moved_px`, sampled every `sampling_pitch_px` pixels.
struct PrincipleFigure {
  double pitch_px = 11.0;
  int sampling_pitch_px = 10;
  double moved_px = 2.0;
  int width_px = 220;
};

[[nodiscard]] Figure principle_of_sampling_moire(const PrincipleFigure& contents);

}  // namespace moiregauge::internal::figure
