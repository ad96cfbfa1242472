// SPDX-License-Identifier: Apache-2.0
// Reads TOML tables key by key. Mistakes are collected with their position in the file, not thrown.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>
#include <toml.hpp>

namespace moiregauge::internal {

// Returns text of a file in a form that is safe in a message: one line, without terminal controls.
[[nodiscard]] std::string printable(std::string text);

// Collects mistakes and returns them in the order of the file, as "file:line:column: text".
class TomlMistakes {
 public:
  explicit TomlMistakes(std::string path) : path_(std::move(path)) {}
  void add(std::size_t line, std::size_t column, const std::string& text);
  void add_at(const toml::value& value, const std::string& text);
  // Adds a mistake at the key instead of its value, if the line contains the key.
  void add_at_key(const toml::value& value, const std::string& key, const std::string& text);
  [[nodiscard]] bool empty() const { return entries_.empty(); }
  [[nodiscard]] std::vector<std::string> lines() const;

 private:
  struct Entry {
    std::size_t line;
    std::size_t column;
    std::string text;
  };
  std::string path_;
  std::vector<Entry> entries_;
};

// Returns an integer or a real number. Returns nothing for NaN, infinity, and numbers beyond the range of a double
// or of 64 bits.
[[nodiscard]] std::optional<double> finite_number(const toml::value& value);

// One table. Absent keys return nothing. Keys of a wrong type return nothing and add a mistake.
class TomlTable {
 public:
  TomlTable(const toml::value& table, TomlMistakes& mistakes) : table_(&table), mistakes_(&mistakes) {}
  // Adds a mistake for every key outside `known`, with the nearest known key.
  void refuse_keys_outside(const std::vector<std::string_view>& known) const;
  [[nodiscard]] const toml::value* find(const std::string& key) const;
  [[nodiscard]] bool has(const std::string& key) const { return find(key) != nullptr; }
  // Returns a finite number. Integers are accepted as real numbers.
  [[nodiscard]] std::optional<double> number(const std::string& key) const;
  [[nodiscard]] std::optional<double> number_above_zero(const std::string& key) const;
  [[nodiscard]] std::optional<double> number_not_negative(const std::string& key) const;
  [[nodiscard]] std::optional<std::array<double, 2>> pair(const std::string& key) const;
  [[nodiscard]] std::optional<std::string> text(const std::string& key) const;
  // Adds a mistake at this key, or at the table's head if the key is absent.
  void mistake(const std::string& key, const std::string& text) const;

 private:
  const toml::value* table_;
  TomlMistakes* mistakes_;
};

inline constexpr std::size_t kTextFileLimit = 64 * 1024;  // bytes: four times a site of 100 markers

// Parses TOML. Refuses text that could exhaust the parser (above the limit, nesting over 32). Never throws.
[[nodiscard]] tl::expected<toml::value, std::string> parse_toml(const std::string& text, const std::string& path,
                                                                std::size_t limit_bytes = kTextFileLimit);

// Returns the bytes of a file. Fails with the path and the reason, also above the limit.
[[nodiscard]] tl::expected<std::string, std::string> read_small_file(const std::string& path, std::size_t limit_bytes);

}  // namespace moiregauge::internal
