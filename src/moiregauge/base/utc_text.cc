// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/base/utc_text.h"

#include <chrono>
#include <optional>

#include <fmt/format.h>

namespace moiregauge::internal {
namespace {

// Reads a text from its start. A failed read leaves nothing valid.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : left_(text) {}
  // Reads exactly `digits` digits.
  [[nodiscard]] std::optional<int> number(std::size_t digits) {
    if (left_.size() < digits) return std::nullopt;
    int value = 0;
    for (const char c : left_.substr(0, digits)) {
      if (c < '0' || c > '9') return std::nullopt;
      value = 10 * value + (c - '0');
    }
    left_.remove_prefix(digits);
    return value;
  }
  [[nodiscard]] bool take(std::string_view any_of) {
    if (left_.empty() || any_of.find(left_.front()) == std::string_view::npos) return false;
    left_.remove_prefix(1);
    return true;
  }
  // Reads the digits of a fraction, without zeros at its end.
  [[nodiscard]] std::string fraction() {
    std::size_t count = left_.find_first_not_of("0123456789");
    if (count == std::string_view::npos) count = left_.size();
    const std::string_view digits = left_.substr(0, count);
    left_.remove_prefix(count);
    const std::size_t last = digits.find_last_not_of('0');
    return std::string(digits.substr(0, last == std::string_view::npos ? 0 : last + 1));
  }
  [[nodiscard]] bool is_finished() const { return left_.empty(); }

 private:
  std::string_view left_;
};

// Reads "Z", "+02:00" or "+0200".
std::optional<std::chrono::minutes> offset_in(Scanner& text) {
  if (text.take("Z")) return std::chrono::minutes(0);
  const bool is_east = text.take("+");
  if (!is_east && !text.take("-")) return std::nullopt;
  const auto hours = text.number(2);
  (void)text.take(":");
  const auto minutes = text.number(2);
  if (!hours || !minutes || *hours > 14 || *minutes > 59) return std::nullopt;
  const auto offset = std::chrono::hours(*hours) + std::chrono::minutes(*minutes);
  return is_east ? offset : -offset;
}

}  // namespace

std::string utc_text(std::string_view iso) {
  Scanner text(iso);
  const auto year = text.number(4);
  const bool has_month = text.take("-");
  const auto month = text.number(2);
  const bool has_day = text.take("-");
  const auto day = text.number(2);
  const bool has_time = text.take("T ");
  const auto hour = text.number(2);
  const bool has_minute = text.take(":");
  const auto minute = text.number(2);
  const bool has_second = text.take(":");
  const auto second = text.number(2);
  if (!has_month || !has_day || !has_time || !has_minute || !has_second) return {};
  if (!year || !month || !day || !hour || !minute || !second) return {};
  const std::string fraction = text.take(".") ? text.fraction() : std::string{};
  const auto offset = offset_in(text);
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
