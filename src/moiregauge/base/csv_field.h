// SPDX-License-Identifier: Apache-2.0
// One field of a CSV file.
#pragma once

#include <cmath>
#include <string>

#include <fmt/format.h>

namespace moiregauge::internal {

// Six decimals, no minus before zero, NaN for what is not known.
[[nodiscard]] inline std::string csv_number(double value) {
  if (std::isnan(value)) return "NaN";
  std::string text = fmt::format("{:.6f}", value);
  return text == "-0.000000" ? "0.000000" : text;
}

// RFC 4180: a text with a comma or a quote is quoted.
[[nodiscard]] inline std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace moiregauge::internal
