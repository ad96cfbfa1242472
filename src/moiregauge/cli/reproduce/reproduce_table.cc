// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/reproduce/reproduce_table.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "moiregauge/cli/reproduce/reproduce_summary.h"

namespace moiregauge::internal::cli {
namespace {

// Formats mm with three significant digits, but at most four decimals.
std::string millimetres(double value) {
  if (!(value > 0.0)) return "0";
  const int digits = std::clamp(2 - static_cast<int>(std::floor(std::log10(value))), 0, 4);
  return fmt::format("{:.{}f}", value, digits);
}

std::string errors(const MethodRun& run) {
  const ErrorSummary summary = summary_of(run.error_mm);
  if (summary.lost == run.error_mm.size()) return "not measured";
  std::string text = fmt::format("{} ({})", millimetres(summary.rms), millimetres(summary.largest));
  if (summary.lost > 0) text += fmt::format("; {} of {} frames lost", summary.lost, run.error_mm.size());
  return text;
}

// Returns the bound of the default method. The conventional method does not track the target, so its budget applies to
// other pixels.
std::string bound(const CellRun& cell) {
  for (const MethodRun& run : cell.methods) {
    const ErrorSummary summary = summary_of(run.bound_mm);
    if (run.method == kDefaultMethod && summary.lost < run.bound_mm.size()) return millimetres(summary.rms);
  }
  return "none";
}

}  // namespace

std::string reproduce_table(const ReproducePlan& plan, const std::vector<CellRun>& cells, bool quick) {
  std::string text =
      "Error of dy in mm: rms (largest) over the run, relative to the simulator's truth since the reference frame.\n";
  if (quick) text += "Quick: the small rig and a few frames, not the paper's rig.\n";
  text += "\n| case | lens | paper |";
  std::string rule = "\n|---|---|---|";
  for (const Method& method : kMethods) {
    text += fmt::format(" {} |", method.name);
    rule += "---|";
  }
  text += " bound |" + rule + "---|\n";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const ReproduceCase& which = plan.cases[i / plan.lenses.size()];
    text += fmt::format("| {} | {} | {:g} |", which.rotation, plan.lenses[i % plan.lenses.size()].name, which.paper_mm);
    for (const MethodRun& run : cells[i].methods) text += fmt::format(" {} |", errors(run));
    text += fmt::format(" {} |\n", bound(cells[i]));
  }
  return text;
}

}  // namespace moiregauge::internal::cli
