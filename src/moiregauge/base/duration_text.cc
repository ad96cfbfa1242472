// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/base/duration_text.h"

#include <array>
#include <charconv>
#include <cmath>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace moiregauge::internal {

namespace {

// Units with their number in a second. Divisors, because 1000 is exact in binary and 0.001 is not.
using Unit = std::pair<std::string_view, double>;
constexpr std::array<Unit, 3> kShortUnits{{{"ms", 1e3}, {"s", 1.0}, {"us", 1e6}}};
constexpr std::array<Unit, 4> kLongUnits{{{"s", 1.0}, {"min", 1.0 / 60.0}, {"h", 1.0 / 3600.0}, {"d", 1.0 / 86400.0}}};

// Words of one range of units for the messages.
struct DurationWords {
  const char* example;  // "18ms"
  const char* first;    // unit to suggest
  const char* others;
  const char* all;
};

tl::expected<double, std::string> duration_in(const std::string& text, std::span<const Unit> units,
                                              const DurationWords& words) {
  const auto trimmed = [](std::string_view t) {
    const std::size_t first = t.find_first_not_of(' ');
    return first == std::string_view::npos ? std::string_view() : t.substr(first, t.find_last_not_of(' ') - first + 1);
  };
  const std::string_view whole = trimmed(text);
  double number = 0.0;
  const auto [end, problem] = std::from_chars(whole.data(), whole.data() + whole.size(), number);
  if (problem != std::errc())
    return tl::unexpected(fmt::format("\"{}\" is not a time, write it like {}", text, words.example));
  const std::string_view word = trimmed(whole.substr(static_cast<std::size_t>(end - whole.data())));
  if (word.empty())
    return tl::unexpected(
        fmt::format("\"{}\" has no unit, write {}{} (or {})", text, whole, words.first, words.others));
  for (const auto& [unit, over] : units) {
    if (unit != word) continue;
    if (std::isfinite(number) && number >= 0.0) return number / over;
    return tl::unexpected(fmt::format("\"{}\" is negative, give 0 or more", text));
  }
  return tl::unexpected(fmt::format("\"{}\" has the unknown unit \"{}\", use {}", text, word, words.all));
}

}  // namespace

tl::expected<double, std::string> duration_s(const std::string& text) {
  return duration_in(text, kShortUnits, {"18ms", "ms", "s, us", "ms, s or us"});
}

tl::expected<double, std::string> long_duration_s(const std::string& text) {
  return duration_in(text, kLongUnits, {"10min", "min", "s, h, d", "s, min, h or d"});
}

}  // namespace moiregauge::internal
