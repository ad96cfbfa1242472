// SPDX-License-Identifier: Apache-2.0
// Comparison of a finished run with another sensor: `moiregauge compare` as an application runs it.
#pragma once

#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "moiregauge/app/solve_run.h"
#include "moiregauge/io/tables/comparison_files.h"
#include "moiregauge/io/tables/reference_csv.h"

namespace moiregauge::internal {

struct CompareArgs {
  SolveArgs solve;          // the run, and the options with which it was solved
  std::string reference;    // CSV file
  std::string channel;      // expression, or "NAME = EXPRESSION"
  std::string time_column;  // empty: 1
  std::string time_unit;    // s, ms, us, min or h; empty: by the header, otherwise s
  std::string column;       // empty: 2, or 1 with a rate
  std::optional<double> rate_hz;
  std::string unit;  // the reference's; empty: that of the channel
  std::optional<double> scale;
  int sign = 1;
  std::optional<double> offset_s;
  std::string output;  // folder; empty: comparison in the run
};

struct ComparedRun {
  Comparison comparison;
  ComparisonOrigin origin;
  std::string folder;
  std::string report;  // the report that shows the comparison; empty: none
  Exit exit = Exit::kMeasured;
};

// Solves the run again in memory, reads the reference, compares, and writes the folder as a whole. Without a folder of
// its own, the run's report shows the comparison too. Nothing else in the run's results changes.
// Fails without writing: as run_channels, or the reference cannot be read, or the records show no common movement.
[[nodiscard]] tl::expected<ComparedRun, RunFailure> run_compare(const CompareArgs& args, const RunCallbacks& callbacks);

}  // namespace moiregauge::internal
