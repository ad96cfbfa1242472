// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/pictures/picture_numbers.h"

#include <algorithm>
#include <charconv>
#include <numeric>

namespace moiregauge::internal {
namespace {

constexpr std::size_t kMaxDigits = 18;  // digits of a number that fits into a long

bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::string_view digit_run(std::string_view text, std::size_t start) {
  std::size_t end = start;
  while (end < text.size() && is_digit(text[end])) ++end;
  return text.substr(start, end - start);
}

std::string_view without_zeros(std::string_view digits) {
  const std::size_t first = digits.find_first_not_of('0');
  return first == std::string_view::npos ? digits.substr(digits.size()) : digits.substr(first);
}

std::string_view stem_of(std::string_view name) {
  const std::size_t dot = name.rfind('.');
  return dot == std::string_view::npos || dot == 0 ? name : name.substr(0, dot);
}

std::vector<std::string_view> digit_runs(std::string_view stem) {
  std::vector<std::string_view> runs;
  for (std::size_t i = 0; i < stem.size();) {
    const std::string_view run = digit_run(stem, i);
    if (!run.empty()) runs.push_back(run);
    i += std::max<std::size_t>(1, run.size());
  }
  return runs;
}

// Returns true for 20261123 or 20261123080512. Times after a date go from 59 s to 100 (one minute), which is no gap.
bool is_date(std::string_view digits) {
  return (digits.size() == 8 || digits.size() == 14) && (digits.starts_with("19") || digits.starts_with("20"));
}

bool is_time_of_day(const std::vector<std::string_view>& runs, std::size_t k) {
  return (runs[k].size() == 14 && is_date(runs[k])) || (k > 0 && is_date(runs[k - 1]) && runs[k].size() >= 6);
}

long value_of(std::string_view digits) {
  long value = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), value);
  return value;
}

}  // namespace

bool comes_before(std::string_view a, std::string_view b) {
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a.size() && j < b.size()) {
    if (is_digit(a[i]) && is_digit(b[j])) {
      const std::string_view run_a = digit_run(a, i);
      const std::string_view run_b = digit_run(b, j);
      const std::string_view value_a = without_zeros(run_a);
      const std::string_view value_b = without_zeros(run_b);
      if (value_a.size() != value_b.size()) return value_a.size() < value_b.size();
      if (value_a != value_b) return value_a < value_b;
      i += run_a.size();
      j += run_b.size();
    } else if (a[i] != b[j]) {
      return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
    } else {
      ++i;
      ++j;
    }
  }
  if (a.size() - i != b.size() - j) return a.size() - i < b.size() - j;
  return a < b;  // frame01 and frame1: any fixed order
}

std::string shape_of_name(std::string_view name) {
  const std::string_view stem = stem_of(name);
  std::string shape;
  for (std::size_t i = 0; i < stem.size(); ++i) {
    if (!is_digit(stem[i]))
      shape += stem[i];
    else if (i == 0 || !is_digit(stem[i - 1]))
      shape += '#';
  }
  return shape;
}

std::optional<std::vector<NumberedName>> numbered_names(const std::vector<std::string>& names) {
  if (names.empty()) return std::nullopt;
  std::vector<std::vector<std::string_view>> runs;
  runs.reserve(names.size());
  for (const std::string& name : names) runs.push_back(digit_runs(stem_of(name)));
  for (std::size_t k = 0; k < runs.front().size(); ++k) {
    std::vector<NumberedName> cut;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (runs[i].size() <= k || runs[i][k].size() > kMaxDigits || is_time_of_day(runs[i], k)) break;
      const std::string_view digits = runs[i][k];
      const auto start = static_cast<std::size_t>(digits.data() - names[i].data());
      const long number = value_of(digits);
      if (!cut.empty() && number <= cut.back().number) break;
      cut.push_back({names[i].substr(0, start), std::string(digits), names[i].substr(start + digits.size()), number});
    }
    if (cut.size() == names.size()) return cut;
  }
  return std::nullopt;
}

long stride_of(const std::vector<long>& numbers) {
  long stride = 0;
  for (std::size_t i = 1; i < numbers.size(); ++i) stride = std::gcd(stride, numbers[i] - numbers[i - 1]);
  return std::max(1L, stride);
}

bool count_frames(const std::vector<long>& numbers, long stride) {
  const long places = (numbers.back() - numbers.front()) / stride + 1;
  return places <= 2 * static_cast<long>(numbers.size()) + 10;
}

}  // namespace moiregauge::internal
