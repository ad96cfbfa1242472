// SPDX-License-Identifier: Apache-2.0
// New results from a finished or interrupted run, without its video: `moiregauge solve` as an application runs it.
#pragma once

#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/app/measure_options.h"
#include "moiregauge/app/measurement_run.h"
#include "moiregauge/io/journal/run_file.h"

namespace moiregauge::internal {

// As typed; an empty text keeps what the run was measured with.
struct SolveArgs {
  std::string run;                  // folder that `measure` wrote
  std::string site;                 // file
  std::string camera;               // file
  std::optional<Site> stated_site;  // instead of the file
  std::optional<Camera> stated_camera;
  std::string method;
  std::string rest;  // A:B in frames or seconds, or "none"
  std::string zero;  // the same
  std::optional<double> fps;
  std::optional<double> slow_motion;
  std::string readout;
  PrintScaleArgs print_scale;
  MarkerChoiceArgs choice;
  std::string output;  // empty: the run's own folder, whose results are replaced
  std::string figures;
  bool quiet = false;
  bool json = false;
};

struct SolvedResults {
  Measurement measurement;
  MeasureOptions options;
  std::string folder;
};

// Options that arguments replace.
enum class RunBase {
  kMeasured,  // those of the measurement
  kResults    // those of the results in the folder, which `solve` may have written
};

// Reads a run's observations and applies the options to them, without solving.
[[nodiscard]] tl::expected<StoredRun, RunFailure> run_to_solve(const SolveArgs& args,
                                                               RunBase base = RunBase::kMeasured);

// Solves a run again without writing anything.
// Fails: the run cannot be read, or the frames contradict a statement.
[[nodiscard]] tl::expected<SolvedResults, RunFailure> solve_in_memory(const SolveArgs& args, RunBase base);

// Checks that displacement.csv of a run contains these samples.
// Fails: it does not exist (kInputUnreadable), or it has other values (kUsage).
[[nodiscard]] tl::expected<void, RunFailure> check_results(const std::string& folder, const Site& site,
                                                           const Samples& samples);

// Solves a run again and writes the results. Fails without writing where the run cannot be read, or where the frames
// contradict a statement.
[[nodiscard]] tl::expected<SolvedResults, RunFailure> run_solve(const SolveArgs& args, const RunCallbacks& callbacks);

}  // namespace moiregauge::internal
