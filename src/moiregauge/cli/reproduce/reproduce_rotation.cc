// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/reproduce/reproduce_rotation.h"

#include <algorithm>
#include <string>

#include "moiregauge/cli/reproduce/reproduce_summary.h"
#include "moiregauge/simulator/simulator.h"

namespace moiregauge::internal::cli {
namespace {

// Returns the range of the rotation in degrees, as counted in the paper: -4 to 4 are 8 degrees.
double swing_deg(const simulator::Scenario& scenario, const simulator::Track& track) {
  double low = track.at(0.0), high = low;
  for (long frame = 0; frame < scenario.frames; ++frame) {
    const double angle = track.at(simulator::time_of(scenario, frame));
    low = std::min(low, angle);
    high = std::max(high, angle);
  }
  return high - low;
}

struct PaperRotation {
  figure::Turn turn = figure::Turn::kOneAxis;
  double rotation_deg = 0.0;
};

PaperRotation paper_rotation_of(const ReproduceCase& which) {
  const auto scenario = scenario_of(which, {});
  const bool about_y_too = swing_deg(scenario, scenario.mount.rotation_y) > 0.0;
  return {about_y_too ? figure::Turn::kAllAxes : figure::Turn::kOneAxis,
          swing_deg(scenario, scenario.mount.rotation_x)};
}

}  // namespace

figure::RotationFigure rotation_of(const ReproducePlan& plan, const std::vector<CellRun>& cells) {
  figure::RotationFigure f;
  for (const ReproduceLens& lens : plan.lenses) {
    f.lenses.push_back({lens.name, {}});
    for (const Method& method : kMethods) f.lenses.back().methods.push_back({std::string(method.name), {}});
  }
  for (std::size_t i = 0; i < plan.cases.size(); ++i) {
    const auto [turn, rotation_deg] = paper_rotation_of(plan.cases[i]);
    f.published.push_back({turn, rotation_deg, plan.cases[i].paper_mm});
    for (std::size_t lens = 0; lens < plan.lenses.size(); ++lens) {
      const CellRun& cell = cells[i * plan.lenses.size() + lens];
      for (std::size_t m = 0; m < cell.methods.size(); ++m) {
        const ErrorSummary errors = summary_of(cell.methods[m].error_mm);
        f.lenses[lens].methods[m].points.push_back({turn, rotation_deg, errors.largest, errors.rms, errors.lost > 0});
      }
    }
  }
  return f;
}

}  // namespace moiregauge::internal::cli
