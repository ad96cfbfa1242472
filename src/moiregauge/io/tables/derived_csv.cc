// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/tables/derived_csv.h"

#include <cmath>

#include <fmt/format.h>

#include "moiregauge/base/csv_field.h"

namespace moiregauge::internal {
namespace {

// Minus zero becomes zero.
std::string nine_digits(double value) { return std::isnan(value) ? "NaN" : fmt::format("{:.9g}", value + 0.0); }

}  // namespace

std::string column_name(const std::string& name, const std::string& unit) {
  std::string text = name + "_";
  for (const char c : unit) text += c == '/' ? std::string("_per_") : std::string(1, c);
  return text;
}

std::string derived_csv(const DerivedTable& table) {
  std::string text = "frame,time_s";
  for (const DerivedColumn& column : table.columns) {
    const std::string name = column_name(column.name, column.unit);
    text += fmt::format(",{0},u_{0},{1}_status", csv_field(name), csv_field(column.name));
  }
  text += "\n";
  for (std::size_t n = 0; n < table.time_s.size(); ++n) {
    text += table.frame.empty() ? std::string("NaN") : fmt::format("{}", table.frame[n]);
    text += "," + csv_number(table.time_s[n]);
    for (const DerivedColumn& column : table.columns)
      text +=
          fmt::format(",{},{},{}", nine_digits(column.value[n]), nine_digits(column.u[n]), word_for(column.status[n]));
    text += "\n";
  }
  return text;
}

}  // namespace moiregauge::internal
