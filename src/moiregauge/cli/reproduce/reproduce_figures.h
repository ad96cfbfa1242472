// SPDX-License-Identifier: Apache-2.0
// Creates the paper's figures and the error against rotation, from simulated images and their measurements.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "moiregauge/cli/reproduce/reproduce_run.h"
#include "moiregauge/drawing/surface/canvas.h"

namespace moiregauge::internal::cli {

// A figure to be made later, because it may take seconds and its images need memory only while it is drawn.
struct FigureJob {
  std::string name;  // "fig02": the paper's number; figures that are not in the paper have names
  std::function<figure::FigureFiles()> make;
};

// Returns the jobs. They refer to `plan` and `cells`.
[[nodiscard]] std::vector<FigureJob> figure_jobs(const ReproducePlan& plan, const std::vector<CellRun>& cells);

}  // namespace moiregauge::internal::cli
