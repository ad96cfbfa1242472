// SPDX-License-Identifier: Apache-2.0
// A simulated recording measured in memory, and its errors against the simulator's truth.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "moiregauge/displacement/method.h"
#include "moiregauge/geometry/camera.h"
#include "moiregauge/simulator/simulator.h"

namespace moiregauge::internal::test {

enum class Grain { kSensor, kNoiseFree };  // as the sensor stores it, or 16 bits without noise

struct RunPlan {
  std::string method = "two-stage";
  Grain grain = Grain::kSensor;
  long first = 0;
  long step = 1;     // every step-th frame of the scenario
  long frames = -1;  // at most so many; -1: to the end
  long reference_frame = 0;
  bool all_targets = false;  // else the first one's samples are kept
  int render_threads = 0;    // 0: as many as there are
  ObserveOptions observe{};
  SolveOptions solve{};
  std::optional<Site> site{};  // not given: the scenario's
  Camera lens{};               // as --camera gives it; without distortion and of focal length 1: not given
};

struct MeasuredRun {
  Reference reference;
  Observations observations;
  Samples samples;                 // of the first target, reference frame left out
  std::vector<double> error_x_um;  // measured minus true, since the reference frame; of samples with numbers
  std::vector<double> error_y_um;
  std::vector<double> u_x_um, u_y_um;
  Solution solution;    // what else the method said; its samples moved to `samples`
  std::string problem;  // empty, or why there is no reference frame
};

[[nodiscard]] MeasuredRun measured(const simulator::Scenario& scenario, const RunPlan& plan);

// Whether the solution says `what`.
[[nodiscard]] bool notes(const MeasuredRun& run, const std::string& what);

[[nodiscard]] double rms(const std::vector<double>& values);
[[nodiscard]] double scatter(const std::vector<double>& values);  // rms about the mean
[[nodiscard]] double largest(const std::vector<double>& values);  // of the magnitudes

}  // namespace moiregauge::internal::test
