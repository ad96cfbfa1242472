// SPDX-License-Identifier: Apache-2.0
// A measurement as an application runs it: opens the input, measures, solves, and writes the run directory as a whole.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/app/run_progress.h"
#include "moiregauge/io/run_dir/unfinished_run.h"
#include "moiregauge/run/measure.h"

namespace moiregauge::internal {

struct RunRequest {
  std::string input;
  InputOptions input_options;
  MeasureOptions options;
  std::string output;                        // DIR
  Earlier earlier = Earlier::kAsk;           // what to do with an unfinished run in DIR
  std::string stabilised;                    // folder of the stabilised markers; empty: none
  std::vector<std::string> figures;          // formats
  bool video = false;                        // DIR/stabilised.mp4
  std::optional<double> video_exaggeration;  // empty: chosen
};

struct RunFailure {
  Exit exit = Exit::kInternalError;
  std::string message;  // "what: where: what to do"
};

struct FinishedRun {
  Measurement measurement;
  std::string folder;                 // holds the results: DIR, or DIR.unfinished after a stop
  std::optional<RunFailure> trouble;  // something besides the results could not be written
};

// Measures request.input into request.output. A stopped run is resumable: its frames are kept in DIR.unfinished.
// Fails without results where input, output or options do not allow a measurement. A refused measurement is no failure:
// its Measurement holds the refusal.
[[nodiscard]] tl::expected<FinishedRun, RunFailure> run_measurement(const RunRequest& request,
                                                                    const RunCallbacks& callbacks);

// Returns overlay.png of a run with its picture. It draws the reference frame, or everything detected in a refused run.
[[nodiscard]] std::vector<std::uint8_t> run_overlay(const Measurement& seen, const MeasureOptions& options);

// Returns an error if --readout is longer than a frame: the rows of one frame are read before those of the next.
[[nodiscard]] std::optional<std::string> readout_problem(const MeasureOptions& options, const InputInfo& input);

// Returns the failure of results that cannot be written.
[[nodiscard]] RunFailure failure_of(const OutputError& error);

}  // namespace moiregauge::internal
