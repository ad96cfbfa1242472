// SPDX-License-Identifier: Apache-2.0
// Options of `moiregauge batch`, as typed and parsed.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <tl/expected.hpp>

#include "moiregauge/app/measure_options.h"
#include "moiregauge/batch/manifest.h"

namespace moiregauge::internal::cli {

// Arguments as typed.
struct BatchArgs {
  std::vector<std::string> inputs;
  std::string output;
  MeasureArgs measure;
  std::vector<CLI::Option*> measure_options;  // those that are passed to `measure`
  int jobs = 0;                               // 0: not given
  std::string time_limit, memory_limit;
  bool retry = false, collect = false, slurm = false, quiet = false;
  int chunk = 0;  // 0: not given
  std::vector<std::string> sbatch;
  std::string query;
  std::string task, manifest;
};

void add_batch_options(CLI::App& command, BatchArgs& args);

enum class BatchMode { kMeasure, kSlurm, kCollect, kQuery, kTask };

// Returns what the command does. Fails if options contradict each other.
[[nodiscard]] tl::expected<BatchMode, UsageError> batch_mode(const BatchArgs& args);

// Returns the options of each clip's measurement. Fails as `measure` would, or for a limit that cannot be read.
[[nodiscard]] tl::expected<ClipOptions, UsageError> clip_options(const BatchArgs& args);

// Distributes the processors: clips at the same time, and threads of each.
struct Shares {
  int jobs = 1, threads = 1;
};
[[nodiscard]] Shares shares_of(const BatchArgs& args, std::size_t clips);

// Returns the processors of a Slurm task, as Slurm states them.
[[nodiscard]] int jobs_of_task(const BatchArgs& args);

}  // namespace moiregauge::internal::cli
