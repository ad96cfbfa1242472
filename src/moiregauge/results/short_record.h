// SPDX-License-Identifier: Apache-2.0
// A vibration of which the record holds few cycles, too few for an averaged spectrum.
#pragma once

#include <optional>

#include "moiregauge/results/peaks.h"
#include "moiregauge/results/sine_fit.h"

namespace moiregauge::internal {

inline constexpr double kMinCycles = 3.0;   // least number of cycles in the record; slower motion is drift
inline constexpr double kFewCycles = 12.0;  // up to here the averaged spectrum may miss a peak

struct ShortVibration {
  SineFit sine;
  Peak peak;
};

// Finds the vibration between `lowest_hz` and `highest_hz` that explains the slow motion of the longest stretch.
// Model: one steady sine on a straight line, in white noise (sine_fit.h).
// Fails (nothing): chance exceeds the fall of the sum of squares once in 10^7 records, or a tenth of the slow motion
// remains. Drift, steps and random walks leave more. A decaying sine would fit a step.
// Error: u of the frequency from the residuals, or from those near the peak if these are larger.
[[nodiscard]] std::optional<ShortVibration> find_short_vibration(const Series& series, const EvenTimes& times,
                                                                 double lowest_hz, double highest_hz);

}  // namespace moiregauge::internal
