// SPDX-License-Identifier: Apache-2.0
// Range of the ok samples of a run, from its displacement.csv.
#pragma once

#include <limits>
#include <map>
#include <string>
#include <string_view>

namespace moiregauge::internal {

struct MarkerMovement {
  double lowest_dx_mm = std::numeric_limits<double>::infinity(), highest_dx_mm = -lowest_dx_mm;
  double lowest_dy_mm = std::numeric_limits<double>::infinity(), highest_dy_mm = -lowest_dy_mm;
  // Peak to peak, mm. Negative: not measured.
  [[nodiscard]] double dx_mm() const { return highest_dx_mm - lowest_dx_mm; }
  [[nodiscard]] double dy_mm() const { return highest_dy_mm - lowest_dy_mm; }
};

using Movements = std::map<std::string, MarkerMovement>;

// Adds the rows of a text that consists of whole lines. Lines that are no rows are skipped.
void add_rows(std::string_view lines, Movements& movements);

// Returns the ranges by marker. Returns none if the file is missing, or longer than 256 MB.
[[nodiscard]] Movements movements_of(const std::string& displacement_csv);

}  // namespace moiregauge::internal
