// SPDX-License-Identifier: Apache-2.0
// A run of errors in two numbers, for the table and for the figure against rotation.
#pragma once

#include <cstddef>
#include <vector>

namespace moiregauge::internal::cli {

struct ErrorSummary {
  double rms = 0.0, largest = 0.0;  // in the unit of the values; NaN of no number at all
  std::size_t lost = 0;             // values that are no number; they count for nothing above
};
[[nodiscard]] ErrorSummary summary_of(const std::vector<double>& values);

}  // namespace moiregauge::internal::cli
