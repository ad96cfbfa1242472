// SPDX-License-Identifier: Apache-2.0
// What a run amounts to: one summary per target, and whether the run as a whole may be trusted.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "moiregauge/displacement/method.h"

namespace moiregauge::internal {

struct TargetSummary {
  std::size_t marker = 0;                     // index in the site
  long frames = 0;                            // rows
  long ok = 0;                                // rows with status ok, the reference frame's included
  std::map<std::string, long> status_counts;  // by word, only those that occur
  Extent<frame::Board> u;                     // mm, rms over the measured rows; NaN when there are none
  Budget budget;                              // mm, rms over the measured rows
  Extent<frame::Board> lowest, highest;       // mm, of the measured rows; NaN when there are none
  Extent<frame::Board> last;                  // mm, the last measured row
  Status last_status = Status::kLost;
};

[[nodiscard]] std::vector<TargetSummary> summarise(const Reference& reference, const Samples& samples);

// The exit codes of the program (docs/cli/measure.md).
enum class Exit {
  kMeasured = 0,
  kInternalError = 1,
  kUsage = 2,
  kInputUnreadable = 3,
  kRefused = 4,
  kIncomplete = 5,
  kOutputUnwritable = 6,
  kSourceLost = 7,
  kInterrupted = 130
};

// More than this share of rows that are not `ok` is a run that needs looking at.
inline constexpr double kNotOkShare = 0.01;

// kMeasured, kRefused (no `ok` row beside the reference frame's) or kIncomplete (too many rows not ok, or damaged input).
[[nodiscard]] Exit exit_of(const Samples& samples, long reference_frame, bool input_damaged);

}  // namespace moiregauge::internal
