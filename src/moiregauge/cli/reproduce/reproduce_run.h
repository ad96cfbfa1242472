// SPDX-License-Identifier: Apache-2.0
// The cases of the paper's section 3, simulated and measured in memory by every method.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/displacement/method.h"
#include "moiregauge/simulator/scenario/scenario.h"

namespace moiregauge::internal::cli {

struct ReproduceCase {
  std::string scenario;   // built-in
  std::string rotation;   // for people
  double paper_mm = 0.0;  // the error the paper reports
  long reference_frame = 0;
  int figure = 0;       // number of the figure with its displacement over time
  int pictures = 0;     // of the one with its pictures; 0: none. The next number shows the target over time
  int captured_px = 0;  // side of that one's crops as captured
};
struct ReproduceLens {
  std::string name;
  double k1 = 0.0;
};
struct ReproducePlan {
  std::vector<ReproduceCase> cases;
  std::vector<ReproduceLens> lenses;
  long step = 1;    // every step-th frame is measured
  int threads = 0;  // 0: all; never changes a number
};

// All vectors by measured frame, the reference frame left out; NaN where the method has no number. dy of the target.
struct MethodRun {
  std::string_view method;
  std::vector<double> time_s, dy_mm, error_mm;  // error: measured minus true, both since the reference frame
  std::vector<double> bound_mm;                 // hypot(noise, references) of the sample's budget
};
struct CellRun {
  std::vector<MethodRun> methods;  // one per row of kMethods
};

[[nodiscard]] ReproducePlan paper_plan();
[[nodiscard]] ReproducePlan quick_plan();  // the small rig, a few frames: whether all of it works, not how well

[[nodiscard]] simulator::Scenario scenario_of(const ReproduceCase& which, const ReproduceLens& lens);

// Simulates and measures one case through one lens; an error says why no reference frame could be made.
[[nodiscard]] tl::expected<CellRun, std::string> run_cell(const ReproduceCase& which, const ReproduceLens& lens,
                                                          long step);

// All cells, case by case, lens by lens. `done` is called (from one thread at a time) after each.
[[nodiscard]] tl::expected<std::vector<CellRun>, std::string> run_plan(const ReproducePlan& plan,
                                                                       const std::function<void(long done)>& done);

}  // namespace moiregauge::internal::cli
