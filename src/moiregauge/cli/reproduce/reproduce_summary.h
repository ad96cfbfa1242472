// SPDX-License-Identifier: Apache-2.0
// Summarises the errors of a run, for the table and for the figure of error against rotation.
#pragma once

#include <cstddef>
#include <vector>

namespace moiregauge::internal::cli {

struct ErrorSummary {
  double rms = 0.0, largest = 0.0;  // unit of the values; NaN without any value
  std::size_t lost = 0;             // values that are not finite; excluded above
};
[[nodiscard]] ErrorSummary summary_of(const std::vector<double>& values);

}  // namespace moiregauge::internal::cli
