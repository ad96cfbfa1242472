// SPDX-License-Identifier: Apache-2.0
// Files of a comparison (docs/file-formats.md).
#pragma once

#include <string>

#include "moiregauge/results/comparison/comparison.h"

namespace moiregauge::internal {

// Origin of a comparison, for its files.
struct ComparisonOrigin {
  std::string run, reference;  // as typed
  std::string channel, unit;   // expression and unit
  double factor = 1.0;         // by which the values of the file were multiplied
};

// Returns comparison.csv: one row per compared moment. Values have nine digits.
[[nodiscard]] std::string comparison_csv(const Comparison& comparison);

// Returns comparison.json: every figure of the comparison. Unknown values are null.
[[nodiscard]] std::string comparison_json(const Comparison& comparison, const ComparisonOrigin& origin);

}  // namespace moiregauge::internal
