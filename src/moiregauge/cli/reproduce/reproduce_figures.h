// SPDX-License-Identifier: Apache-2.0
// The counterparts of the paper's figures, and the error against rotation, from simulated pictures and what was
// measured.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "moiregauge/cli/reproduce/reproduce_run.h"
#include "moiregauge/drawing/surface/canvas.h"

namespace moiregauge::internal::cli {

// A figure still to be made: making it may take seconds, and its pictures live only while it is drawn.
struct FigureJob {
  std::string name;  // "fig02": the paper's number; a figure the paper has not is named in words
  std::function<figure::FigureFiles()> make;
};

// The jobs refer to plan and cells.
[[nodiscard]] std::vector<FigureJob> figure_jobs(const ReproducePlan& plan, const std::vector<CellRun>& cells);

}  // namespace moiregauge::internal::cli
