// SPDX-License-Identifier: Apache-2.0
// Collects the data for the figure of error against camera rotation from the runs of a plan.
#pragma once

#include <vector>

#include "moiregauge/cli/reproduce/reproduce_run.h"
#include "moiregauge/drawing/figures/figure_rotation.h"

namespace moiregauge::internal::cli {

// Returns the errors of every case, lens and method.
[[nodiscard]] figure::RotationFigure rotation_of(const ReproducePlan& plan, const std::vector<CellRun>& cells);

}  // namespace moiregauge::internal::cli
