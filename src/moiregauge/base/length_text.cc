// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/base/length_text.h"

#include <array>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace moiregauge::internal {
namespace {

// Factors below 1 are divisors, because 1000 is exact in binary and 0.001 is not: 10000um is 10 mm to the last bit.
struct LengthUnit {
  std::string_view word;
  double times;
  double over;
};
constexpr std::array<LengthUnit, 7> kUnits{{{"mm", 1.0, 1.0},
                                            {"cm", 10.0, 1.0},
                                            {"m", 1000.0, 1.0},
                                            {"um", 1.0, 1000.0},
                                            {"\xc2\xb5m", 1.0, 1000.0},  // U+00B5, micro sign
                                            {"\xce\xbcm", 1.0, 1000.0},  // U+03BC, Greek mu
                                            {"in", 25.4, 1.0}}};

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(' ');
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(' ') - first + 1);
}

}  // namespace

tl::expected<double, std::string> length_mm(const std::string& text) {
  const std::string_view whole = trimmed(text);
  double number = 0.0;
  const auto [end, problem] = std::from_chars(whole.data(), whole.data() + whole.size(), number);
  if (problem != std::errc()) return tl::unexpected(fmt::format("\"{}\" is not a length, write it like 10mm", text));
  const std::string_view word = trimmed(whole.substr(static_cast<std::size_t>(end - whole.data())));
  if (word.empty()) {
    return tl::unexpected(fmt::format("\"{}\" has no unit, write {}mm (or cm, m, um, in)", text, whole));
  }
  if (word.front() == ',') return tl::unexpected(fmt::format("\"{}\" has a comma, write a decimal point", text));
  for (const LengthUnit& unit : kUnits) {
    if (unit.word != word) continue;
    const double length = number * unit.times / unit.over;
    if (std::isfinite(length) && length > 0.0) return length;
    return tl::unexpected(fmt::format("\"{}\" must be greater than 0, give a positive length", text));
  }
  return tl::unexpected(fmt::format("\"{}\" has the unknown unit \"{}\", use mm, cm, m, um or in", text, word));
}

}  // namespace moiregauge::internal
