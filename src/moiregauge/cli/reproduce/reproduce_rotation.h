// SPDX-License-Identifier: Apache-2.0
// What the figure of error against camera rotation shows, from the runs of a plan.
#pragma once

#include <vector>

#include "moiregauge/cli/reproduce/reproduce_run.h"
#include "moiregauge/drawing/figures/figure_rotation.h"

namespace moiregauge::internal::cli {

// Of every case, lens and method.
[[nodiscard]] figure::RotationFigure rotation_of(const ReproducePlan& plan, const std::vector<CellRun>& cells);

}  // namespace moiregauge::internal::cli
