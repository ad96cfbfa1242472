// SPDX-License-Identifier: Apache-2.0
// Tables of TOML read key by key, every mistake collected with its place in the file instead of thrown.
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

// What a file holds as it may stand in a message: one line, and nothing that a terminal obeys.
[[nodiscard]] std::string printable(std::string text);

// Collects "file:line:column: text" and gives them back in the order of the file.
class TomlMistakes {
 public:
  explicit TomlMistakes(std::string path) : path_(std::move(path)) {}
  void add(std::size_t line, std::size_t column, const std::string& text);
  void add_at(const toml::value& value, const std::string& text);
  // At the key rather than its value, where the line shows it.
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

// A whole or a real number as the file has it; nothing for NaN, for infinity, and beyond what a double (or, of a whole
// number, 64 bits) can hold.
[[nodiscard]] std::optional<double> finite_number(const toml::value& value);

// One table. Absent keys give nothing and are no mistake; keys of a wrong type give nothing and are one.
class TomlTable {
 public:
  TomlTable(const toml::value& table, TomlMistakes& mistakes) : table_(&table), mistakes_(&mistakes) {}
  // Marks every key outside `known` as a mistake, with the nearest known key.
  void refuse_keys_outside(const std::vector<std::string_view>& known) const;
  [[nodiscard]] const toml::value* find(const std::string& key) const;
  [[nodiscard]] bool has(const std::string& key) const { return find(key) != nullptr; }
  // Finite numbers only; a whole number passes for a real one.
  [[nodiscard]] std::optional<double> number(const std::string& key) const;
  [[nodiscard]] std::optional<double> number_above_zero(const std::string& key) const;
  [[nodiscard]] std::optional<double> number_not_negative(const std::string& key) const;
  [[nodiscard]] std::optional<std::array<double, 2>> pair(const std::string& key) const;
  [[nodiscard]] std::optional<std::string> text(const std::string& key) const;
  // A mistake at this key, or at the table's head when the key is absent.
  void mistake(const std::string& key, const std::string& text) const;

 private:
  const toml::value* table_;
  TomlMistakes* mistakes_;
};

inline constexpr std::size_t kTextFileLimit = 64 * 1024;  // bytes; a site of a hundred markers needs a quarter of it

// Parses after refusing what could exhaust the parser (too long, nesting over 32); never throws.
[[nodiscard]] tl::expected<toml::value, std::string> parse_toml(const std::string& text, const std::string& path,
                                                                std::size_t limit_bytes = kTextFileLimit);

// A file's bytes up to the limit, or why not, as "path: what is wrong".
[[nodiscard]] tl::expected<std::string, std::string> read_small_file(const std::string& path, std::size_t limit_bytes);

}  // namespace moiregauge::internal
