// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <sstream>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "moiregauge/base/plain_file.h"
#include "moiregauge/io/config/toml_table.h"
#include "moiregauge/io/config/toml_version.h"

namespace moiregauge::internal {
namespace {

// Brackets within brackets, or dots in a key (chosen: real files have fewer than 5).
constexpr int kDeepestNesting = 32;

// Returns the first line with too deep nesting. A recursive parser would exhaust the stack on it. Brackets inside
// strings count as well, which harms no real file.
std::optional<std::size_t> line_nested_too_deep(const std::string& text) {
  int brackets = 0;
  int dots_in_key = 0;
  bool in_key = true;
  bool in_comment = false;
  std::size_t line = 1;
  for (const char c : text) {
    if (c == '\n') {
      ++line;
      dots_in_key = 0;
      in_key = true;
      in_comment = false;
    }
    if (c == '#') in_comment = true;
    if (in_comment) continue;
    if (c == '=') in_key = false;
    if (c == ',' || c == '{') dots_in_key = 0;
    if (c == '[' || c == '{') ++brackets;
    if (c == ']' || c == '}') brackets = std::max(0, brackets - 1);
    if (c == '.' && in_key) ++dots_in_key;
    if (brackets > kDeepestNesting || dots_in_key > kDeepestNesting) return line;
  }
  return std::nullopt;
}

// Returns the first line that is not UTF-8, as TOML requires. The error text of toml11 3.7.1 for such a string reads
// beyond the text (found by fuzzing). The test is to write the line with nlohmann's JSON, which refuses it.
std::optional<std::size_t> line_not_utf8(const std::string& text) {
  std::istringstream lines(text);
  std::size_t number = 1;
  for (std::string line; std::getline(lines, line); ++number) {
    try {
      static_cast<void>(nlohmann::json(line).dump());
    } catch (const nlohmann::json::type_error&) {
      return number;
    }
  }
  return std::nullopt;
}

// Returns the first line with a control character, which TOML forbids. toml11 4.4 does not return from such a comment
// (found by fuzzing).
std::optional<std::size_t> line_with_control(const std::string& text) {
  std::size_t line = 1;
  for (const char c : text) {
    if (c == '\n') ++line;
    const bool is_control = static_cast<unsigned char>(c) < 0x20 || c == '\x7f';
    if (is_control && c != '\n' && c != '\r' && c != '\t') return line;
  }
  return std::nullopt;
}

// Reduces toml11's message of several lines with a drawing to one line.
std::string first_line_of(const std::string& what) {
  std::string line = what.substr(0, what.find('\n'));
  for (const char* prefix : {"[error] ", "toml::", "detail::"}) {
    if (line.rfind(prefix, 0) == 0) line.erase(0, std::strlen(prefix));
  }
  if (const auto colon = line.find(": "); colon != std::string::npos && line.find(' ') > colon)
    line.erase(0, colon + 2);
  // The texts of toml11 3 and 4, and ours for both.
  static constexpr std::pair<std::string_view, std::string_view> kOurs[] = {
      {"invalid line format", "there is text after the value, write numbers like 1.5, without a unit"},
      {"newline (LF / CRLF) or EOF", "there is text after the value, write numbers like 1.5, without a unit"},
      {"missing key-value separator", "there is no = after the key"},
      {"invalid key value separator", "there is no = after the key"},
      {"already exists", "the key or table is given twice"},
      {"already defined", "the key or table is given twice"},
      {"failed to read floating point", "the value must be a finite number"},
      {"too large integer", "the value must be a finite number"}};
  for (const auto& [theirs, ours] : kOurs) {
    if (line.find(theirs) != std::string::npos) return std::string(ours);
  }
  return line;
}

}  // namespace

tl::expected<toml::value, std::string> parse_toml(const std::string& text, const std::string& path,
                                                  std::size_t limit_bytes) {
  if (text.size() > limit_bytes) {
    return tl::unexpected(
        fmt::format("{}:1:1: the file is larger than {} kB, check that it is the right one", path, limit_bytes / 1024));
  }
  if (text.find('\0') != std::string::npos) return tl::unexpected(fmt::format("{}:1:1: this is not a text file", path));
  if (const auto line = line_not_utf8(text)) {
    return tl::unexpected(fmt::format("{}:{}:1: the text is not UTF-8, save the file as UTF-8", path, *line));
  }
  if (const auto line = line_with_control(text)) {
    return tl::unexpected(fmt::format("{}:{}:1: there is a control character, write plain text", path, *line));
  }
  if (const auto line = line_nested_too_deep(text)) {
    return tl::unexpected(
        fmt::format("{}:{}:1: brackets or dots are nested deeper than {}", path, *line, kDeepestNesting));
  }
  try {
    std::istringstream stream(text);
    return toml::parse(stream, path);
  } catch (const toml::exception& error) {
    const TomlPosition at = position_of(error);
    return tl::unexpected(
        fmt::format("{}:{}:{}: {}", path, at.line, at.column, printable(first_line_of(error.what()))));
  } catch (const std::exception& error) {
    return tl::unexpected(fmt::format("{}:1:1: {}", path, printable(first_line_of(error.what()))));
  }
}

tl::expected<std::string, std::string> read_small_file(const std::string& path, std::size_t limit_bytes) {
  const auto file = open_plain_file(path);
  if (!file) return tl::unexpected(fmt::format("{}: cannot be read: {}", path, file.error()));
  std::string text(limit_bytes + 1, '\0');
  text.resize(std::fread(text.data(), 1, text.size(), file->get()));
  if (std::ferror(file->get()) != 0)
    return tl::unexpected(fmt::format("{}: cannot be read: {}", path, std::strerror(errno)));
  if (text.size() > limit_bytes) {
    return tl::unexpected(
        fmt::format("{}:1:1: the file is larger than {} kB, check that it is the right one", path, limit_bytes / 1024));
  }
  return text;
}

}  // namespace moiregauge::internal
