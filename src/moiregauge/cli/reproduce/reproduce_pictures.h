// SPDX-License-Identifier: Apache-2.0
// Draws the figures with images: simulated, and measured by the two-stage method.
#pragma once

#include "moiregauge/cli/reproduce/reproduce_run.h"
#include "moiregauge/drawing/surface/canvas.h"

namespace moiregauge::internal::cli {

[[nodiscard]] figure::FigureFiles tilted_circles();                               // Figure 4
[[nodiscard]] figure::FigureFiles stabilised_frames(const ReproduceCase& which);  // Figures 8 and 10
[[nodiscard]] figure::FigureFiles target_over_time(const ReproduceCase& which);   // Figures 9 and 11

}  // namespace moiregauge::internal::cli
