// SPDX-License-Identifier: Apache-2.0
// Text of a batch: one line while it runs, and three lines at its end.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "moiregauge/batch/batch_run.h"
#include "moiregauge/batch/collect.h"
#include "moiregauge/results/summary.h"

namespace moiregauge::internal::cli {

// Returns a line such as "batch [####....] 57/200 clips, 3 failed, 2 running, 41 s left".
[[nodiscard]] std::string batch_line(const BatchProgress& progress, double elapsed_s);

// Shows the line on a terminal, from the third second on, at most five times a second.
class BatchLine {
 public:
  explicit BatchLine(bool quiet);
  ~BatchLine();
  BatchLine(const BatchLine&) = delete;
  BatchLine& operator=(const BatchLine&) = delete;
  void show(const BatchProgress& progress);
  void show_text(const std::string& text);
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  bool is_wanted_, is_shown_ = false;
  Clock::time_point start_ = Clock::now(), last_ = start_;
};

// Returns the final lines: what was found, the outcomes, and what to do next.
[[nodiscard]] std::string totals_text(const BatchTotals& totals, std::size_t skipped, const std::string& folder);

// Returns a warning for each of the first few clips that other processes are measuring, and the number of all of them.
[[nodiscard]] std::string busy_text(const std::vector<std::string>& names, const std::string& folder);

// Returns the exit code of a batch: 0 all clips measured; 4 none; 5 some.
[[nodiscard]] Exit exit_of_batch(const BatchTotals& totals);

}  // namespace moiregauge::internal::cli
