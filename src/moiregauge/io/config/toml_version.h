// SPDX-License-Identifier: Apache-2.0
// The differences between toml11 3 (Debian 12) and toml11 4 (Debian 13).
#pragma once

#include <cstddef>
#include <string>

#include <toml.hpp>

namespace moiregauge::internal {

// Position in a TOML file. Lines and columns count from 1.
struct TomlPosition {
  std::size_t line = 1;
  std::size_t column = 1;
  std::string text;  // the whole line
};

#if TOML11_VERSION_MAJOR >= 4

inline TomlPosition position_of(const toml::source_location& place) {
  if (!place.is_ok()) return {};
  return {place.first_line_number(), place.first_column_number(),
          place.lines().empty() ? std::string() : place.lines().front()};
}

inline TomlPosition position_of(const toml::value& value) { return position_of(value.location()); }

inline TomlPosition position_of(const toml::exception& error) {
  const auto* syntax = dynamic_cast<const toml::syntax_error*>(&error);
  if (syntax == nullptr || syntax->errors().empty() || syntax->errors().front().locations().empty()) return {};
  return position_of(syntax->errors().front().locations().front().first);
}

inline const std::string& string_in(const toml::value& value) { return value.as_string(std::nothrow); }

#else

inline TomlPosition position_of(const toml::source_location& place) {
  return {place.line(), place.column(), place.line_str()};
}

inline TomlPosition position_of(const toml::value& value) { return position_of(value.location()); }

inline TomlPosition position_of(const toml::exception& error) { return position_of(error.location()); }

inline const std::string& string_in(const toml::value& value) { return value.as_string(std::nothrow).str; }

#endif

}  // namespace moiregauge::internal
