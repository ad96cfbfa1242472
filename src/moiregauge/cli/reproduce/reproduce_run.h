// SPDX-License-Identifier: Apache-2.0
// Simulates the cases of the paper's section 3, and measures them in memory by every method.
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
  std::string rotation;   // for the reader
  double paper_mm = 0.0;  // published error
  long reference_frame = 0;
  int figure = 0;       // number of the figure with displacement over time
  int pictures = 0;     // number of the figure with images; 0: none. The next number shows the target over time
  int captured_px = 0;  // px, side of its crops as captured
};
struct ReproduceLens {
  std::string name;
  double k1 = 0.0;
};
struct ReproducePlan {
  std::vector<ReproduceCase> cases;
  std::vector<ReproduceLens> lenses;
  long step = 1;    // every step-th frame is measured
  int threads = 0;  // 0: all; results do not depend on it
};

// Results of one method: dy of the target by measured frame, without the reference frame. NaN: no value.
struct MethodRun {
  std::string_view method;
  std::vector<double> time_s, dy_mm, error_mm;  // error: measured minus true; both are relative to the reference frame
  std::vector<double> bound_mm;                 // hypot(noise, references) of the sample's budget
};
struct CellRun {
  std::vector<MethodRun> methods;  // one per row of kMethods
};

[[nodiscard]] ReproducePlan paper_plan();
[[nodiscard]] ReproducePlan quick_plan();  // small rig, few frames: tests function, not accuracy

[[nodiscard]] simulator::Scenario scenario_of(const ReproduceCase& which, const ReproduceLens& lens);

// Simulates and measures one case with one lens. Fails if no reference frame could be made.
[[nodiscard]] tl::expected<CellRun, std::string> run_cell(const ReproduceCase& which, const ReproduceLens& lens,
                                                          long step);

// Runs all cells, case by case and lens by lens. Calls `done` after each, from one thread at a time.
[[nodiscard]] tl::expected<std::vector<CellRun>, std::string> run_plan(const ReproducePlan& plan,
                                                                       const std::function<void(long done)>& done);

}  // namespace moiregauge::internal::cli
