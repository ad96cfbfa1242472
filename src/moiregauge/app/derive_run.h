// SPDX-License-Identifier: Apache-2.0
// Derived channels of a finished run: `moiregauge derive` as an application runs it.
#pragma once

#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/app/solve_run.h"
#include "moiregauge/results/derived/derived_table.h"

namespace moiregauge::internal {

struct DeriveArgs {
  SolveArgs solve;  // the run, and the options with which it was solved
  std::vector<std::string> channels;
  std::string output;  // CSV file; empty: derived.csv in the run
};

struct DerivedResults {
  DerivedTable table;
  std::string file;                   // the CSV file
  std::vector<std::string> warnings;  // for the user
  Exit exit = Exit::kMeasured;
};

// Solves the run again in memory, computes the channels and writes them. Nothing in the run's own results changes.
// Fails without writing: the run cannot be read, its results have other values, or a channel is wrong.
[[nodiscard]] tl::expected<DerivedResults, RunFailure> run_derive(const DeriveArgs& args,
                                                                  const RunCallbacks& callbacks);

}  // namespace moiregauge::internal
