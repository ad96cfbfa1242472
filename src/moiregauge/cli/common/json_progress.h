// SPDX-License-Identifier: Apache-2.0
// Progress of a run as JSON lines on stderr, for programs that show it (--progress json).
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "moiregauge/app/run_progress.h"
#include "moiregauge/cli/common/sample_lines.h"

namespace moiregauge::internal::cli {

class JsonProgress {
 public:
  enum class Samples { kNone, kProvisional };
  explicit JsonProgress(Samples samples);
  JsonProgress(const JsonProgress&) = delete;
  JsonProgress& operator=(const JsonProgress&) = delete;
  ~JsonProgress();  // writes what is left
  // Refers to this object, which must outlive the run. Ctrl-C stops the run.
  [[nodiscard]] const RunCallbacks& callbacks() const { return callbacks_; }

 private:
  using Clock = std::chrono::steady_clock;
  void show(const RunProgress& progress);
  void keep(const ProvisionalFrame& frame);
  void write();

  RunCallbacks callbacks_;
  std::optional<RunProgress> latest_;  // not written yet
  SampleLines rows_;                   // not written yet
  std::string view_;                   // line of the newest frame; empty: written
  std::optional<Stage> stage_;         // written last
  Clock::time_point written_ = {};
};

// Adds --progress. `format` becomes "json", or stays empty. It must outlive the command.
void add_progress(CLI::App& command, std::string& format);

}  // namespace moiregauge::internal::cli
