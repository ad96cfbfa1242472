// SPDX-License-Identifier: Apache-2.0
// Summary of a run: one entry per target, and the exit code.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "moiregauge/displacement/method.h"

namespace moiregauge::internal {

struct TargetSummary {
  std::size_t marker = 0;                     // index in the site
  long frames = 0;                            // rows
  long ok = 0;                                // rows with status ok, with the reference frame's
  std::map<std::string, long> status_counts;  // by word, only those that occur
  Extent<frame::Board> u;  // mm, rms over the ok rows, or the measured ones if none is ok; NaN if there are none
  Budget budget;           // mm, rms over the same rows
  Extent<frame::Board> lowest, highest;  // mm, of the ok rows; NaN if there are none
  Extent<frame::Board> rms;              // mm, about the mean, of the ok rows; NaN if there are none

  [[nodiscard]] Extent<frame::Board> peak_to_peak() const { return highest - lowest; }
  [[nodiscard]] double largest_movement_mm() const;  // the larger peak to peak of both axes; 0 if there are no ok rows
};

// Returns one summary per target. Only rows whose status has numbers are measured rows.
[[nodiscard]] std::vector<TargetSummary> summarise(const Reference& reference, const Samples& samples);

// Returns the indices of the targets, the largest movement first. Targets of equal movement keep their order.
[[nodiscard]] std::vector<std::size_t> by_movement(const std::vector<TargetSummary>& targets);

// Exit codes of the program (docs/cli/measure.md).
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

// Share of rows that are not `ok` above which a run is incomplete. Chosen.
inline constexpr double kNotOkShare = 0.01;

// Returns kMeasured, kRefused (no `ok` row besides the reference frame's) or kIncomplete (too many rows not ok, or
// damaged input).
[[nodiscard]] Exit exit_of(const Samples& samples, long reference_frame, bool input_damaged);

}  // namespace moiregauge::internal
