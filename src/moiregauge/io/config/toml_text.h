// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <fmt/format.h>

namespace moiregauge::internal {

// Returns the shortest text that reads back to the same bits. TOML requires a point in a real number.
[[nodiscard]] inline std::string toml_real(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

}  // namespace moiregauge::internal
