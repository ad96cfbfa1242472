// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/reproduce/reproduce_run.h"

#include <cmath>
#include <mutex>
#include <optional>

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "moiregauge/displacement/follower.h"
#include "moiregauge/simulator/simulator.h"

namespace moiregauge::internal::cli {
namespace {

using simulator::Scenario;

simulator::Picture shot(const Scenario& scenario, long frame) {
  return simulator::render(scenario, frame, {.threads = 1, .area = simulator::Area::kMarkersOnly});
}

GreyPicture grey(const simulator::Picture& picture, const Scenario& scenario) {
  return {simulator::view_of(picture), scenario.sensor.bits};
}

// State of one method while it processes the frames.
struct Walk {
  const Method* method;
  Follower follower;
  Observations observations;

  void see(const GreyPicture& picture, const Reference& reference, long frame, double time_s) {
    Observation seen = method->observe(picture, reference, follower.prediction());
    seen.frame = frame;
    seen.time_s = time_s;
    observations.push_back(seen);
    (void)follower.follow(reference, observations.back());
  }
};

std::size_t first_target(const Site& site) {
  std::size_t i = 0;
  while (site.markers[i].role != Role::kTarget) ++i;
  return i;
}

MethodRun compared(const Walk& walk, const Reference& reference, const Scenario& scenario) {
  MethodRun run;
  run.method = walk.method->name;
  const std::size_t target = first_target(reference.site);
  const auto* marker = simulator::find_marker(scenario, reference.site.markers[target].name);
  const double then_mm = truth(scenario, reference.seen.frame, *marker).dy_mm;
  for (const Sample& s : walk.method->solve(reference, walk.observations, {}).samples) {
    if (s.marker != target || s.frame == reference.seen.frame) continue;
    const double measured = has_numbers(s.status) ? s.displacement.y : kNotMeasured;
    run.time_s.push_back(simulator::time_of(scenario, s.frame));
    run.dy_mm.push_back(measured);
    run.error_mm.push_back(measured - (truth(scenario, s.frame, *marker).dy_mm - then_mm));
    run.bound_mm.push_back(std::hypot(s.budget.noise.y, s.budget.references.y));
  }
  return run;
}

}  // namespace

ReproducePlan paper_plan() {
  return {.cases = {{"rig-0.1x", "0.1° about x", 0.02, 0, 12, 0, 0},
                    {"rig-1x", "1° about x", 0.248, 0, 13, 0, 0},
                    {"rig-1xyz", "1° about x, y and z", 0.311, 0, 14, 8, 200},
                    // Reference: the frame in which the camera faces the board, as in the paper.
                    {"rig-8xyz", "8° about x, y and z", 1.861, 80, 15, 10, 700}},
          // k1 by the distortion at the corner of the sensor, 2317 px from its centre.
          .lenses = {{"no distortion", 0.0}, {"lens −1 %", -0.0225}, {"lens −2 %", -0.0451}, {"lens −3 %", -0.0676}},
          .step = 2};
}

// Without the case of 8 degrees, in which markers leave the image of the small rig.
ReproducePlan quick_plan() {
  return {.cases = {{"small-0.1x", "0.1° about x", 0.02, 0, 12, 0, 0},
                    {"small-1x", "1° about x", 0.248, 0, 13, 0, 0},
                    {"small-1xyz", "1° about x, y and z", 0.311, 0, 14, 8, 200}},
          .lenses = {{"no distortion", 0.0}, {"lens −1 %", -0.370}},
          .step = 40};
}

Scenario scenario_of(const ReproduceCase& which, const ReproduceLens& lens) {
  Scenario scenario = simulator::built_in(which.scenario).value();
  scenario.camera.k1 = lens.k1;
  return scenario;
}

tl::expected<CellRun, std::string> run_cell(const ReproduceCase& which, const ReproduceLens& lens, long step) {
  const Scenario scenario = scenario_of(which, lens);
  const auto first = shot(scenario, which.reference_frame);
  // Without a known lens, as in the paper.
  auto reference = make_reference(grey(first, scenario), simulator::site_of(scenario), Camera{}, {});
  if (!reference) return tl::unexpected(which.scenario + ": " + reference.error().message);
  reference->seen.frame = which.reference_frame;
  for (const Method& method : kMethods) {
    if (method.prepare != nullptr) method.prepare(grey(first, scenario), *reference);
  }
  std::vector<Walk> walks;
  walks.reserve(std::size(kMethods));
  for (const Method& method : kMethods) walks.push_back({&method, Follower(*reference), Observations(*reference)});
  for (long frame = 0; frame < scenario.frames; frame += step) {
    const auto picture = shot(scenario, frame);
    for (Walk& walk : walks) walk.see(grey(picture, scenario), *reference, frame, simulator::time_of(scenario, frame));
  }
  CellRun cell;
  for (const Walk& walk : walks) cell.methods.push_back(compared(walk, *reference, scenario));
  return cell;
}

tl::expected<std::vector<CellRun>, std::string> run_plan(const ReproducePlan& plan,
                                                         const std::function<void(long done)>& done) {
  std::vector<CellRun> cells(plan.cases.size() * plan.lenses.size());
  std::mutex mutex;
  std::optional<std::string> problem;
  long count = 0;
  tbb::task_arena arena(plan.threads > 0 ? plan.threads : tbb::task_arena::automatic);
  arena.execute([&] {
    tbb::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t i) {
      auto cell = run_cell(plan.cases[i / plan.lenses.size()], plan.lenses[i % plan.lenses.size()], plan.step);
      const std::scoped_lock lock(mutex);
      if (cell)
        cells[i] = *std::move(cell);
      else if (!problem)
        problem = cell.error();
      done(++count);
    });
  });
  if (problem) return tl::unexpected(*problem);
  return cells;
}

}  // namespace moiregauge::internal::cli
