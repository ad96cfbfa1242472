// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/reproduce/reproduce_summary.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace moiregauge::internal::cli {

ErrorSummary summary_of(const std::vector<double>& values) {
  ErrorSummary summary;
  double squares = 0.0;
  for (const double v : values) {
    if (!std::isfinite(v)) {
      ++summary.lost;
      continue;
    }
    squares += v * v;
    summary.largest = std::max(summary.largest, std::abs(v));
  }
  if (summary.lost == values.size()) {
    summary.rms = summary.largest = std::numeric_limits<double>::quiet_NaN();
  } else {
    summary.rms = std::sqrt(squares / static_cast<double>(values.size() - summary.lost));
  }
  return summary;
}

}  // namespace moiregauge::internal::cli
