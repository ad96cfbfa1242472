// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/tables/time_cell.h"

#include <array>
#include <chrono>
#include <utility>

#include "moiregauge/base/digit_scanner.h"

namespace moiregauge::internal {
namespace {

using Days = std::chrono::sys_days;

std::optional<Days> date_of(int year, int month, int day) {
  const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  if (!date.ok()) return std::nullopt;
  return Days(date);
}

// Reads "2026-11-25T" or "25.11.2026 ", with the character before the time.
std::optional<Days> date_in(DigitScanner& text) {
  const auto first = text.number(1, 4);
  const bool is_iso = text.take("-");
  if (!first || (!is_iso && !text.take("."))) return std::nullopt;
  const auto month = text.number(1, 2);
  const bool has_third = text.take(is_iso ? "-" : ".");
  const auto third = text.number(1, 4);
  if (!month || !has_third || !third || !text.take("T ")) return std::nullopt;
  return is_iso ? date_of(*first, *month, *third) : date_of(*third, *month, *first);
}

// Reads "10:00:00.25".
std::optional<double> time_of_day_in(DigitScanner& text) {
  const auto hour = text.number(1, 2);
  const bool has_minute = text.take(":");
  const auto minute = text.number(2, 2);
  const bool has_second = text.take(":");
  const auto second = text.number(2, 2);
  if (!hour || !has_minute || !minute || !has_second || !second) return std::nullopt;
  if (*hour > 23 || *minute > 59 || *second > 59) return std::nullopt;
  double fraction = 0.0, digit = 0.1;
  if (text.take(".,")) {
    for (const char c : text.digits()) fraction += digit * (c - '0'), digit /= 10.0;
  }
  return 3600.0 * *hour + 60.0 * *minute + *second + fraction;
}

}  // namespace

std::optional<ClockTime> clock_time(std::string_view text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) return std::nullopt;
  const bool has_date = colon > 2;  // an hour has at most two digits
  DigitScanner scanner(text);
  Days date{};
  if (has_date) {
    const auto found = date_in(scanner);
    if (!found) return std::nullopt;
    date = *found;
  }
  const auto time = time_of_day_in(scanner);
  if (!time) return std::nullopt;
  ClockTime out{*time, has_date};
  if (has_date) out.seconds += std::chrono::duration<double>(date.time_since_epoch()).count();
  if (has_date && !scanner.is_finished()) {
    const auto zone = scanner.zone();
    if (!zone) return std::nullopt;
    out.seconds -= std::chrono::duration<double>(*zone).count();
  }
  if (!scanner.is_finished()) return std::nullopt;
  return out;
}

std::optional<double> seconds_of_unit(std::string_view unit) {
  constexpr std::array<std::pair<std::string_view, double>, 7> kUnits{
      {{"s", 1.0}, {"sec", 1.0}, {"ms", 1e-3}, {"us", 1e-6}, {"\xC2\xB5s", 1e-6}, {"min", 60.0}, {"h", 3600.0}}};
  for (const auto& [name, seconds] : kUnits) {
    if (name == unit) return seconds;
  }
  return std::nullopt;
}

std::optional<std::string> time_unit_in(std::string_view name) {
  if (!name.empty() && (name.back() == ']' || name.back() == ')')) name.remove_suffix(1);
  const std::size_t before = name.find_last_of("_ [(/");
  const std::string_view unit = before == std::string_view::npos ? name : name.substr(before + 1);
  if (!seconds_of_unit(unit)) return std::nullopt;
  return std::string(unit);
}

}  // namespace moiregauge::internal
