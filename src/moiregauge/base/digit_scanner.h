// SPDX-License-Identifier: Apache-2.0
// Reads dates and times from texts.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string_view>

namespace moiregauge::internal {

// Reads a text from its start. What was read is removed, so that the next call continues there.
class DigitScanner {
 public:
  explicit DigitScanner(std::string_view text) : left_(text) {}
  // Returns a number of `min` to `max` digits. Nothing: there are fewer.
  [[nodiscard]] std::optional<int> number(std::size_t min, std::size_t max) {
    int value = 0;
    std::size_t count = 0;
    for (; count < max && count < left_.size() && is_digit(left_[count]); ++count)
      value = 10 * value + (left_[count] - '0');
    if (count < min) return std::nullopt;
    left_.remove_prefix(count);
    return value;
  }
  // Returns true if the next character is one of these.
  [[nodiscard]] bool take(std::string_view any_of) {
    if (left_.empty() || any_of.find(left_.front()) == std::string_view::npos) return false;
    left_.remove_prefix(1);
    return true;
  }
  // Returns all digits that follow.
  [[nodiscard]] std::string_view digits() {
    std::size_t count = 0;
    while (count < left_.size() && is_digit(left_[count])) ++count;
    const std::string_view digits = left_.substr(0, count);
    left_.remove_prefix(count);
    return digits;
  }
  // Returns the offset of a time zone: "Z", "+02:00" or "+0200".
  [[nodiscard]] std::optional<std::chrono::minutes> zone() {
    if (take("Z")) return std::chrono::minutes(0);
    const bool is_east = take("+");
    if (!is_east && !take("-")) return std::nullopt;
    const auto hours = number(2, 2);
    (void)take(":");
    const auto minutes = number(2, 2);
    if (!hours || !minutes || *hours > 14 || *minutes > 59) return std::nullopt;
    const auto offset = std::chrono::hours(*hours) + std::chrono::minutes(*minutes);
    return is_east ? offset : -offset;
  }
  [[nodiscard]] bool is_finished() const { return left_.empty(); }

 private:
  [[nodiscard]] static bool is_digit(char c) { return c >= '0' && c <= '9'; }
  std::string_view left_;
};

}  // namespace moiregauge::internal
