// SPDX-License-Identifier: Apache-2.0
// Derived channels of a finished run: `moiregauge derive` as an application runs it.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/app/solve_run.h"
#include "moiregauge/report/report_additions.h"
#include "moiregauge/results/derived/channel_values.h"
#include "moiregauge/results/derived/derived_table.h"
#include "moiregauge/results/derived/statistics.h"
#include "moiregauge/results/modes/mode_shapes.h"

namespace moiregauge::internal {

struct DeriveArgs {
  SolveArgs solve;                    // the run, and the options with which it was solved
  std::vector<std::string> channels;  // empty: those of the site file
  // Layers in their order: option without dashes and value, such as "filter" and "lowpass:5Hz".
  std::vector<std::pair<std::string, std::string>> layers;
  std::string output;         // CSV file; empty: derived.csv in the run
  bool is_in_memory = false;  // nothing is written
  bool has_modes = false;     // also mode shapes; then channels may be absent
};

struct DerivedResults {
  DerivedTable table;
  std::vector<ChannelStatistics> statistics;  // in the order of the columns
  std::string report;                         // the report that shows the channels; empty: none
  std::vector<ModeShape> modes;               // by frequency
  std::vector<std::string> targets;           // names, for the modes
  std::vector<std::string> files;             // written, the main ones
  std::vector<std::string> warnings;          // for the user
  Exit exit = Exit::kMeasured;
};

struct RunChannels {
  std::vector<Channel> channels;      // in the order of the texts
  std::vector<ChannelSeries> series;  // one per channel
  Exit exit = Exit::kMeasured;        // the run's own
};

// Solves the run again in memory and computes the channels. They may name channels of the site file. Writes nothing.
// Fails: the run cannot be read, its results have other values, or a channel is wrong.
[[nodiscard]] tl::expected<RunChannels, RunFailure> run_channels(const SolveArgs& args,
                                                                 const std::vector<std::string>& channels,
                                                                 const RunCallbacks& callbacks);

// Solves the run again in memory, computes the channels and writes them. Without an output of its own, the run's report
// shows them too. Nothing else in the run's results changes.
// Fails without writing: the run cannot be read, its results have other values, or a channel is wrong.
[[nodiscard]] tl::expected<DerivedResults, RunFailure> run_derive(const DeriveArgs& args,
                                                                  const RunCallbacks& callbacks);

// Adds a script to the report of a run and returns its path. Without a report it adds a note to `warnings` and returns
// an empty path. Fails: the report could not be written.
[[nodiscard]] tl::expected<std::string, RunFailure> shown_in_report(const std::string& run, const PageScript& script,
                                                                    std::vector<std::string>& warnings);

}  // namespace moiregauge::internal
