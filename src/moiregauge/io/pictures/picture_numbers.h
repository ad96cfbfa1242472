// SPDX-License-Identifier: Apache-2.0
// The number in the names of a recording's pictures: from it follows which of them are missing.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace moiregauge::internal {

// Compares names as people order them: digits by their value, so frame9 comes before frame10.
[[nodiscard]] bool comes_before(std::string_view a, std::string_view b);

// A file name cut around the digits that count the picture: "cam2_", "0017", ".png".
struct NumberedName {
  std::string before;
  std::string digits;
  std::string after;
  long number = 0;
};

// Cuts names that are in natural order, and whose text differs only in their endings. The number is the first run of
// digits that grows from name to name. Nothing where none does, or where it is a time of day.
[[nodiscard]] std::optional<std::vector<NumberedName>> numbered_names(const std::vector<std::string>& names);

// A name without its ending and with every run of digits as one '#': names of one recording agree in it.
[[nodiscard]] std::string shape_of_name(std::string_view name);

// The largest step that reaches every number from the first (ascending numbers): 10 for 0, 10, 30. 1 for a single one.
[[nodiscard]] long stride_of(const std::vector<long>& numbers);

// Do these numbers count frames? Not if more of them are missing than there are, and over ten.
[[nodiscard]] bool count_frames(const std::vector<long>& numbers, long stride);

}  // namespace moiregauge::internal
