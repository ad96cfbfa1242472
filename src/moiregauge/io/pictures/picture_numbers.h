// SPDX-License-Identifier: Apache-2.0
// Finds the frame number in image names, and so the missing images.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace moiregauge::internal {

// Returns true if `a` precedes `b` in natural order: digits by their value, so frame9 precedes frame10.
[[nodiscard]] bool comes_before(std::string_view a, std::string_view b);

// A file name split at the digits of the frame number: "cam2_", "0017", ".png".
struct NumberedName {
  std::string before;
  std::string digits;
  std::string after;
  long number = 0;
};

// Splits names that are in natural order and differ only in their extension and digits. The number is the first
// group of digits that increases from name to name. Returns nothing without such a group, or if it is a time of day.
[[nodiscard]] std::optional<std::vector<NumberedName>> numbered_names(const std::vector<std::string>& names);

// Returns the name without extension, with every group of digits as one '#'. Names of one recording have the same
// shape.
[[nodiscard]] std::string shape_of_name(std::string_view name);

// Returns the largest stride that reaches every number from the first (ascending): 10 for 0, 10, 30. Returns 1 for a
// single number.
[[nodiscard]] long stride_of(const std::vector<long>& numbers);

// Returns true if these numbers count frames. Returns false if more are missing than present, by more than ten.
[[nodiscard]] bool count_frames(const std::vector<long>& numbers, long stride);

}  // namespace moiregauge::internal
