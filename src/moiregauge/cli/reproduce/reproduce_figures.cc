// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/reproduce/reproduce_figures.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "moiregauge/cli/reproduce/reproduce_pictures.h"
#include "moiregauge/cli/reproduce/reproduce_rotation.h"
#include "moiregauge/drawing/figures/figure_principle.h"
#include "moiregauge/drawing/figures/figure_rotation.h"
#include "moiregauge/drawing/figures/figure_series.h"
#include "moiregauge/simulator/simulator.h"

namespace moiregauge::internal::cli {
namespace {

// The first two lenses: no distortion, and the smallest.
constexpr std::size_t kLensesShown = 2;

figure::SeriesFigure series_of(const ReproducePlan& plan, const std::vector<CellRun>& cells, std::size_t index) {
  const ReproduceCase& which = plan.cases[index];
  const auto scenario = scenario_of(which, plan.lenses.front());
  const auto* target = simulator::find_marker(scenario, "mid");
  figure::SeriesFigure f;
  f.rotation = which.rotation;
  for (long frame = 0; frame < scenario.frames; ++frame) {
    const double time = simulator::time_of(scenario, frame);
    f.time_s.push_back(time);
    f.true_mm.push_back(truth(scenario, frame, *target).dy_mm);
    f.camera_deg.push_back(scenario.mount.rotation_x.at(time));
  }
  // Adds the target's displacement in the reference frame, so that the curve coincides with the truth.
  const double offset = truth(scenario, which.reference_frame, *target).dy_mm;
  for (std::size_t m = 0; m < kMethods.size(); ++m) {
    figure::MethodCurves curves{.method = std::string(kMethods[m].name), .lenses = {}};
    for (std::size_t lens = 0; lens < std::min(kLensesShown, plan.lenses.size()); ++lens) {
      const MethodRun& run = cells[index * plan.lenses.size() + lens].methods[m];
      figure::MeasuredCurve curve{plan.lenses[lens].name, run.time_s, run.dy_mm, run.error_mm};
      for (double& v : curve.displacement_mm) v += offset;
      curves.lenses.push_back(std::move(curve));
    }
    f.methods.push_back(std::move(curves));
  }
  return f;
}

std::string figure_name(int number) { return fmt::format("fig{:02d}", number); }

}  // namespace

std::vector<FigureJob> figure_jobs(const ReproducePlan& plan, const std::vector<CellRun>& cells) {
  std::vector<FigureJob> jobs;
  jobs.push_back({figure_name(2), [] { return files_of(figure::principle_of_sampling_moire({})); }});
  jobs.push_back({figure_name(4), [] { return tilted_circles(); }});
  jobs.push_back({"error-against-rotation",
                  [&plan, &cells] { return files_of(error_against_rotation(rotation_of(plan, cells))); }});
  for (std::size_t i = 0; i < plan.cases.size(); ++i) {
    const ReproduceCase& which = plan.cases[i];
    if (which.pictures > 0) {
      jobs.push_back({figure_name(which.pictures), [&which] { return stabilised_frames(which); }});
      jobs.push_back({figure_name(which.pictures + 1), [&which] { return target_over_time(which); }});
    }
    jobs.push_back({figure_name(which.figure),
                    [&plan, &cells, i] { return files_of(displacement_over_time(series_of(plan, cells, i))); }});
  }
  std::sort(jobs.begin(), jobs.end(), [](const FigureJob& a, const FigureJob& b) { return a.name < b.name; });
  return jobs;
}

}  // namespace moiregauge::internal::cli
