// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/config/toml_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include <fmt/format.h>

#include "moiregauge/base/nearest_word.h"
#include "moiregauge/io/config/toml_version.h"

namespace moiregauge::internal {

std::string printable(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == '\x7f') c = '?';
  }
  return text;
}

void TomlMistakes::add(std::size_t line, std::size_t column, const std::string& text) {
  entries_.push_back({line, column, printable(text)});
}

void TomlMistakes::add_at(const toml::value& value, const std::string& text) {
  const TomlPosition at = position_of(value);
  add(at.line, at.column, text);
}

void TomlMistakes::add_at_key(const toml::value& value, const std::string& key, const std::string& text) {
  const TomlPosition at = position_of(value);
  const std::size_t found = at.text.find(key);
  add(at.line, found == std::string::npos ? at.column : found + 1, text);
}

std::vector<std::string> TomlMistakes::lines() const {
  std::vector<Entry> sorted = entries_;
  std::stable_sort(sorted.begin(), sorted.end(), [](const Entry& a, const Entry& b) {
    return std::tie(a.line, a.column) < std::tie(b.line, b.column);
  });
  std::vector<std::string> lines;
  lines.reserve(sorted.size());
  for (const Entry& entry : sorted) {
    lines.push_back(fmt::format("{}:{}:{}: {}", path_, entry.line, entry.column, entry.text));
  }
  return lines;
}

void TomlTable::refuse_keys_outside(const std::vector<std::string_view>& known) const {
  for (const auto& [key, value] : table_->as_table()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    const auto nearest = nearest_word(key, known);
    mistakes_->add_at_key(value, key,
                          nearest ? fmt::format("the key \"{}\" is unknown, did you mean \"{}\"?", key, *nearest)
                                  : fmt::format("the key \"{}\" is unknown", key));
  }
}

const toml::value* TomlTable::find(const std::string& key) const {
  const auto& entries = table_->as_table();
  const auto found = entries.find(key);
  return found == entries.end() ? nullptr : &found->second;
}

void TomlTable::mistake(const std::string& key, const std::string& text) const {
  const toml::value* value = find(key);
  mistakes_->add_at(value != nullptr ? *value : *table_, text);
}

// toml11 replaces a number out of range (1e999) by the largest one, so the largest ones are refused.
std::optional<double> finite_number(const toml::value& value) {
  constexpr auto kLast = std::numeric_limits<toml::value::integer_type>::max();
  constexpr double kLargest = std::numeric_limits<double>::max();
  if (value.is_integer()) {
    const toml::value::integer_type read = value.as_integer(std::nothrow);
    return read < kLast && read > -kLast ? std::optional(static_cast<double>(read)) : std::nullopt;
  }
  if (!value.is_floating()) return std::nullopt;
  const double read = value.as_floating(std::nothrow);
  return std::abs(read) < kLargest ? std::optional(read) : std::nullopt;  // false for NaN
}

std::optional<double> TomlTable::number(const std::string& key) const {
  const toml::value* value = find(key);
  if (value == nullptr) return std::nullopt;
  const auto read = finite_number(*value);
  if (!read) mistake(key, fmt::format("{} must be a finite number", key));
  return read;
}

std::optional<double> TomlTable::number_above_zero(const std::string& key) const {
  const auto read = number(key);
  if (!read || *read > 0.0) return read;
  mistake(key, fmt::format("{} must be greater than 0, not {}", key, *read));
  return std::nullopt;
}

std::optional<double> TomlTable::number_not_negative(const std::string& key) const {
  const auto read = number(key);
  if (!read || *read >= 0.0) return read;
  mistake(key, fmt::format("{} must not be negative, it is {}", key, *read));
  return std::nullopt;
}

std::optional<std::array<double, 2>> TomlTable::pair(const std::string& key) const {
  const toml::value* value = find(key);
  if (value == nullptr) return std::nullopt;
  if (value->is_array() && value->as_array(std::nothrow).size() == 2) {
    const auto first = finite_number(value->as_array(std::nothrow)[0]);
    const auto second = finite_number(value->as_array(std::nothrow)[1]);
    if (first && second) return std::array{*first, *second};
  }
  mistake(key, fmt::format("{} must be two finite numbers, as in [12.0, -3.5]", key));
  return std::nullopt;
}

std::optional<std::string> TomlTable::text(const std::string& key) const {
  const toml::value* value = find(key);
  if (value == nullptr) return std::nullopt;
  if (value->is_string()) return string_in(*value);
  mistake(key, fmt::format("{} must be a text in quotes", key));
  return std::nullopt;
}

}  // namespace moiregauge::internal
