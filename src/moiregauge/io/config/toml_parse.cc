// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "moiregauge/base/plain_file.h"
#include "moiregauge/io/config/toml_table.h"
#include "moiregauge/io/config/toml_version.h"

namespace moiregauge::internal {
namespace {

// Brackets within brackets, or dots in a key (chosen: real files have fewer than 5).
constexpr int kDeepestNesting = 32;

// Returns the length of the quotes at `at` that open or close a string: 3, 1, or 0 for none.
std::size_t quotes_at(const std::string& text, std::size_t at, char quote) {
  if (text[at] != quote) return 0;
  return text.substr(at, 3) == std::string(3, quote) ? 3 : 1;
}

struct BlankedText {
  std::string comments;              // without comments
  std::string comments_and_strings;  // only keys, numbers and brackets remain
};

// Replaces comments and the content of strings by spaces, so that positions stay. A string that its line does not end
// ends there. toml11 4.4 does not return from a comment next to some mistakes (found by fuzzing).
BlankedText blanked(const std::string& text) {
  BlankedText out{text, text};
  const auto blank = [&](std::size_t i, bool is_comment) {
    if (text[i] == '\n' || text[i] == '\r') return;
    out.comments_and_strings[i] = ' ';
    if (is_comment) out.comments[i] = ' ';
  };
  std::size_t i = 0;
  while (i < text.size()) {
    if (text[i] == '#') {
      for (; i < text.size() && text[i] != '\n'; ++i) blank(i, true);
    } else if (text[i] == '"' || text[i] == '\'') {
      const char quote = text[i];
      const std::size_t length = quotes_at(text, i, quote);
      for (i += length; i < text.size() && (length == 3 || text[i] != '\n'); ++i) {
        if (quotes_at(text, i, quote) >= length) break;
        blank(i, false);
        if (quote == '"' && text[i] == '\\' && i + 1 < text.size()) blank(++i, false);
      }
      i = std::min(i + length, text.size());
    } else {
      ++i;
    }
  }
  return out;
}

// Returns the first line with too deep nesting. A recursive parser would exhaust the stack on it.
std::optional<std::size_t> line_nested_too_deep(const std::string& text) {
  int brackets = 0;
  int dots_in_key = 0;
  bool in_key = true;
  std::size_t line = 1;
  for (const char c : text) {
    if (c == '\n') {
      ++line;
      dots_in_key = 0;
      in_key = true;
    }
    if (c == '=') in_key = false;
    if (c == ',' || c == '{') dots_in_key = 0;
    if (c == '[' || c == '{') ++brackets;
    if (c == ']' || c == '}') brackets = std::max(0, brackets - 1);
    if (c == '.' && in_key) ++dots_in_key;
    if (brackets > kDeepestNesting || dots_in_key > kDeepestNesting) return line;
  }
  return std::nullopt;
}

// Returns the first line with a key inside an array that is not closed. On some of these, toml11 4.4 exhausts the stack.
// This was found by fuzzing.
std::optional<std::size_t> line_in_open_array(const std::string& text) {
  std::string open;  // brackets
  std::size_t line = 1;
  for (const char c : text) {
    if (c == '\n') ++line;
    if (c == '[' || c == '{') open.push_back(c);
    if ((c == ']' || c == '}') && !open.empty()) open.pop_back();
    if (c == '=' && !open.empty() && open.back() == '[') return line;
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

// Returns what a line defines: the key before `=`, or the table in brackets.
std::string defined_in_line(const std::string& text, std::size_t line) {
  std::istringstream lines(text);
  std::string found;
  for (std::size_t k = 0; k < line; ++k) std::getline(lines, found);
  found = found.substr(0, found.find(found.rfind('[', 0) == 0 ? '#' : '='));
  while (!found.empty() && (found.back() == ' ' || found.back() == '\t' || found.back() == '\r')) found.pop_back();
  return found;
}

// Returns one sentence for toml11's message, which has several lines with a drawing. Versions 3 and 4 differ in their
// texts, so frequent mistakes have a text of ours. `line` is that of the mistake in the file.
std::string sentence_for(const std::string& what, const std::string& text, std::size_t line) {
  std::string first = what.substr(0, what.find('\n'));
  const auto is_about = [&](const char* theirs) { return first.find(theirs) != std::string::npos; };
  if (is_about("invalid line format") || is_about("newline (LF / CRLF) or EOF"))
    return "there is text after the value, write numbers like 1.5, without a unit";
  if (is_about("missing key-value separator") || is_about("invalid key value separator"))
    return "there is no = after the key";
  if (is_about("already exists") || is_about("already defined")) return defined_in_line(text, line) + " is given twice";
  if (is_about("failed to read floating point") || is_about("too large integer"))
    return "the value must be a finite number";
  for (const char* prefix : {"[error] ", "toml::", "detail::"}) {
    if (first.rfind(prefix, 0) == 0) first.erase(0, std::strlen(prefix));
  }
  if (const auto colon = first.find(": "); colon != std::string::npos && first.find(' ') > colon)
    first.erase(0, colon + 2);
  return first;
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
  const BlankedText plain = blanked(text);
  if (const auto line = line_nested_too_deep(plain.comments_and_strings)) {
    return tl::unexpected(
        fmt::format("{}:{}:1: brackets or dots are nested deeper than {}", path, *line, kDeepestNesting));
  }
  if (const auto line = line_in_open_array(plain.comments_and_strings)) {
    return tl::unexpected(fmt::format("{}:{}:1: a ] is missing before this line's =", path, *line));
  }
  try {
    std::istringstream stream(plain.comments);
    return toml::parse(stream, path);
  } catch (const toml::exception& error) {
    const TomlPosition at = position_of(error);
    return tl::unexpected(
        fmt::format("{}:{}:{}: {}", path, at.line, at.column, printable(sentence_for(error.what(), text, at.line))));
  } catch (const std::exception& error) {
    return tl::unexpected(fmt::format("{}:1:1: {}", path, printable(sentence_for(error.what(), text, 1))));
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
