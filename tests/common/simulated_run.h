// SPDX-License-Identifier: Apache-2.0
// Measurement of a simulated recording in memory, with its errors against the truth.
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
  long frames = -1;  // largest number of frames; -1: all
  long reference_frame = 0;
  bool all_targets = false;  // otherwise only the samples of the first target
  int render_threads = 0;    // 0: one per processor
  ObserveOptions observe{};
  SolveOptions solve{};
  std::optional<Site> site{};  // empty: that of the scenario
  Camera lens{};               // as with --camera; the default is no given camera
};

struct MeasuredRun {
  Reference reference;
  Observations observations;
  Samples samples;                 // for the first target, without the reference frame
  std::vector<double> error_x_um;  // measured minus true, since the reference frame, of samples with values
  std::vector<double> error_y_um;
  std::vector<double> u_x_um, u_y_um;
  Solution solution;    // the method's solution; its samples are moved to `samples`
  std::string problem;  // reason if there is no reference frame, otherwise empty
};

[[nodiscard]] MeasuredRun measured(const simulator::Scenario& scenario, const RunPlan& plan);

// Returns true if a note or finding of the solution contains `what`.
[[nodiscard]] bool notes(const MeasuredRun& run, const std::string& what);

[[nodiscard]] double rms(const std::vector<double>& values);
[[nodiscard]] double scatter(const std::vector<double>& values);  // rms about the mean
[[nodiscard]] double largest(const std::vector<double>& values);  // largest magnitude

}  // namespace moiregauge::internal::test
