// SPDX-License-Identifier: Apache-2.0
// Formats one field of a CSV file.
#pragma once

#include <cmath>
#include <string>

#include <fmt/format.h>

namespace moiregauge::internal {

// Returns the number with six decimals. Minus zero becomes zero, an unknown value "NaN".
[[nodiscard]] inline std::string csv_number(double value) {
  if (std::isnan(value)) return "NaN";
  std::string text = fmt::format("{:.6f}", value);
  return text == "-0.000000" ? "0.000000" : text;
}

// Returns the text, quoted by RFC 4180 if it contains a comma, a quote or a line feed.
[[nodiscard]] inline std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace moiregauge::internal
