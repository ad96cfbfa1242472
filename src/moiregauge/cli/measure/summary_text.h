// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "moiregauge/run/result_sink.h"

namespace moiregauge::internal::cli {

// The three lines at the end of a run: what was found, the result with its uncertainty, what to do next.
[[nodiscard]] std::string summary_text(const Measurement& measurement, const MeasureOptions& options,
                                       const std::string& output);

struct ReportArgs {
  std::string input;   // as typed
  std::string output;  // folder of the results
  bool quiet = false;
  bool json = false;  // run.json instead of the three lines
};

// Says how a run ended on stdout and stderr; returns its exit code.
int report(const Measurement& measurement, const MeasureOptions& options, const ReportArgs& args);

// Results that could not be written.
int fail_output(const OutputError& error);

}  // namespace moiregauge::internal::cli
