// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/base/duration_text.h"

#include <array>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace moiregauge::internal {

tl::expected<double, std::string> duration_s(const std::string& text) {
  // Divisors, because 1000 is exact in binary and 0.001 is not.
  constexpr std::array<std::pair<std::string_view, double>, 3> kUnits{{{"ms", 1e3}, {"s", 1.0}, {"us", 1e6}}};
  const auto trimmed = [](std::string_view t) {
    const std::size_t first = t.find_first_not_of(' ');
    return first == std::string_view::npos ? std::string_view() : t.substr(first, t.find_last_not_of(' ') - first + 1);
  };
  const std::string_view whole = trimmed(text);
  double number = 0.0;
  const auto [end, problem] = std::from_chars(whole.data(), whole.data() + whole.size(), number);
  if (problem != std::errc()) return tl::unexpected(fmt::format("\"{}\" is not a time, write it like 18ms", text));
  const std::string_view word = trimmed(whole.substr(static_cast<std::size_t>(end - whole.data())));
  if (word.empty()) return tl::unexpected(fmt::format("\"{}\" has no unit, write {}ms (or s, us)", text, whole));
  for (const auto& [unit, over] : kUnits) {
    if (unit != word) continue;
    if (std::isfinite(number) && number >= 0.0) return number / over;
    return tl::unexpected(fmt::format("\"{}\" is negative, give 0 or more", text));
  }
  return tl::unexpected(fmt::format("\"{}\" has the unknown unit \"{}\", use ms, s or us", text, word));
}

}  // namespace moiregauge::internal
