// SPDX-License-Identifier: Apache-2.0
// Finds the time offset of two records of one movement by their correlation, over all offsets.
#pragma once

#include <string>

#include <tl/expected.hpp>

#include "moiregauge/results/series.h"

namespace moiregauge::internal {

// Sign: the clock of the reference shows the recording's time plus the offset.
struct LagSearch {
  double step_s = 0.0;                  // grid on which the offsets were tried
  double offset_s = 0.0;                // to half a step
  double correlation = 0.0;             // at this offset
  double next_offset_s = kNotMeasured;  // best offset outside the peak; NaN if there is none
  double next_correlation = 0.0;        // at that offset
  double independent_rows = 0.0;        // samples in the overlap, reduced by their autocorrelation
  bool is_significant = false;          // chance gives such a correlation in less than kMaxChance of all cases
  bool is_opposite = false;             // a correlation of the other sign is significant and explains more
  bool is_ambiguous = false;            // the next offset fits as well, as in a periodic movement
};

inline constexpr double kMaxChance = 1e-3;  // probability that unrelated records align (chosen)

// Correlates both series on one grid, whose step is that of the slower series. At most 262144 cells cover a series.
// At every offset mean and variance are those of the overlap, and gaps are excluded. The offset with the largest
// likelihood of a common movement is chosen: -n/2 log(1 - r^2), for r > 0 and n common cells.
// Significance: n is reduced by the autocorrelation of both (Bartlett 1935). The number of offsets enters by
// Bonferroni's bound.
// Fails (reason): a series has less than two values, or they are constant.
[[nodiscard]] tl::expected<LagSearch, std::string> search_lag(const Series& measured, const Series& reference);

}  // namespace moiregauge::internal
