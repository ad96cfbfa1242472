// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "moiregauge/run/result_sink.h"

namespace moiregauge::internal::cli {

// Returns the text at the end of a run: what was found, the result with its uncertainty, the next step.
[[nodiscard]] std::string summary_text(const Measurement& measurement, const MeasureOptions& options,
                                       const std::string& output);

struct ReportArgs {
  std::string input;   // as typed
  std::string output;  // folder of the results
  bool quiet = false;
  bool json = false;  // run.json instead of the text
};

// Prints the end of a run to stdout and stderr; returns its exit code.
int report(const Measurement& measurement, const MeasureOptions& options, const ReportArgs& args);

// Prints that results could not be written; returns the exit code.
int fail_output(const OutputError& error);

}  // namespace moiregauge::internal::cli
