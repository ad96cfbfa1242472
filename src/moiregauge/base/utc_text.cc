// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/base/utc_text.h"

#include <chrono>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "moiregauge/base/digit_scanner.h"

namespace moiregauge::internal {
std::string utc_text(std::string_view iso) {
  DigitScanner text(iso);
  const auto year = text.number(4, 4);
  const bool has_month = text.take("-");
  const auto month = text.number(2, 2);
  const bool has_day = text.take("-");
  const auto day = text.number(2, 2);
  const bool has_time = text.take("T ");
  const auto hour = text.number(2, 2);
  const bool has_minute = text.take(":");
  const auto minute = text.number(2, 2);
  const bool has_second = text.take(":");
  const auto second = text.number(2, 2);
  if (!has_month || !has_day || !has_time || !has_minute || !has_second) return {};
  if (!year || !month || !day || !hour || !minute || !second) return {};
  std::string_view fraction = text.take(".") ? text.digits() : std::string_view{};
  fraction = fraction.substr(0, fraction.find_last_not_of('0') + 1);  // also right if there is no other digit
  const auto offset = text.zone();
  const std::chrono::year_month_day date{std::chrono::year(*year), std::chrono::month(static_cast<unsigned>(*month)),
                                         std::chrono::day(static_cast<unsigned>(*day))};
  if (!offset || !text.is_finished() || !date.ok() || *hour > 23 || *minute > 59 || *second > 59) return {};
  const auto local = std::chrono::sys_days(date) + std::chrono::hours(*hour) + std::chrono::minutes(*minute);
  const auto utc = local - *offset;
  const auto utc_day = std::chrono::floor<std::chrono::days>(utc);
  const std::chrono::year_month_day utc_date(utc_day);
  const auto minutes = std::chrono::duration_cast<std::chrono::minutes>(utc - utc_day).count();
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}{}{}Z", static_cast<int>(utc_date.year()),
                     static_cast<unsigned>(utc_date.month()), static_cast<unsigned>(utc_date.day()), minutes / 60,
                     minutes % 60, *second, fraction.empty() ? "" : ".", fraction);
}

}  // namespace moiregauge::internal
