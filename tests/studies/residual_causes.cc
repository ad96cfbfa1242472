// SPDX-License-Identifier: Apache-2.0
#include "studies/residual_causes.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "moiregauge/simulator/simulator.h"
#include "paper/exact_points.h"

namespace moiregauge::internal::test {
namespace {

using simulator::Scenario;
using simulator::SceneMarker;

struct Cause {
  std::string name;
  std::function<void(Scenario&)> apply;
};

Cause lens(const char* name, double k1) {
  return {fmt::format("lens {}", name), [k1](Scenario& s) { s.camera.k1 = k1; }};
}

// Returns the cause of a target behind the references' plane, with the camera's pivot behind the lens.
Cause off_plane_cause(double behind_mm, double pivot_mm) {
  return {fmt::format("target {:.0f} mm behind the plane, pivot {:.0f} mm behind the lens", behind_mm, pivot_mm),
          [=](Scenario& s) {
            s.mount.pivot_z_mm = -pivot_mm;
            for (SceneMarker& m : s.markers) {
              if (m.print.role == Role::kTarget) m.place.z_mm = -behind_mm;
            }
          }};
}

// Returns the cause of references that are displaced from their stated positions, with opposite signs on the two
// diagonals. A tilt of the plane cannot explain this pattern.
Cause references_moved(const char* what, double x_mm, double y_mm, double z_mm) {
  return {what, [=](Scenario& s) {
            for (SceneMarker& m : s.markers) {
              if (m.print.role != Role::kReference) continue;
              const double sign = m.print.circle->centre.x * m.print.circle->centre.y > 0.0 ? 1.0 : -1.0;
              m.place.x_mm = sign * x_mm;
              m.place.y_mm = sign * y_mm;
              m.place.z_mm = sign * z_mm;
            }
          }};
}

std::vector<Cause> causes() {
  return {{"nothing", [](Scenario&) {}},
          lens("-0.3 %", -0.00676),
          lens("-1 %", -0.0225),
          lens("-2 %", -0.0451),
          lens("-3 %", -0.0676),
          {"tangential, p1 = p2 = 0.0005",
           [](Scenario& s) {
             s.camera.p1 = 5e-4;
             s.camera.p2 = 5e-4;
           }},
          off_plane_cause(1, 100),
          off_plane_cause(10, 100),
          off_plane_cause(30, 100),
          off_plane_cause(30, 0),
          off_plane_cause(100, 170),
          references_moved("references +-3 mm off their plane, by diagonals", 0, 0, 3),
          references_moved("references 0.3 mm from the site's positions, along diagonals", 0.3, 0.3, 0)};
}

double largest_dy_um(const Scenario& scenario, long reference_frame) {
  double most = 0.0;
  for (long frame = 0; frame < scenario.frames; frame += 4)
    most = std::max(most, std::abs(1000.0 * exact_error(scenario, frame, reference_frame, Stages::kBoth).y));
  return most;
}

}  // namespace

void print_residual_causes(std::span<const PaperCase> cases) {
  std::string head = "| cause |", rule = "|---|", paper = "| *the paper's rig* |";
  for (const PaperCase& c : cases) {
    head += fmt::format(" {} |", c.scenario);
    rule += "---|";
    paper += fmt::format(" *{}* |", c.paper);
  }
  fmt::print(
      "\n## What the residuals are made of\n\nLargest error of dy over the run, um, of the published two stages on "
      "exact points: no pixels, no noise, one cause at a time (docs/methods/two-stage.md).\n\n{}\n{}\n",
      head, rule);
  for (const Cause& cause : causes()) {
    std::string row = fmt::format("| {} |", cause.name);
    for (const PaperCase& c : cases) {
      auto scenario = *simulator::built_in(c.scenario);
      scenario.sensor.exposure_s = 1e-6;  // s; exact points are computed for one instant
      cause.apply(scenario);
      row += fmt::format(" {:.2f} |", largest_dy_um(scenario, c.reference_frame));
    }
    fmt::print("{}\n", row);
  }
  fmt::print("{}\n", paper);
}

}  // namespace moiregauge::internal::test
