// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/tables/table_csv.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "moiregauge/base/csv_field.h"

namespace moiregauge::internal {

namespace {

// Joins the cells of one line, and writes their decimal points as the style has them.
class Line {
 public:
  explicit Line(const TableStyle& style) : style_(style) {}
  Line& text(const std::string& value) {
    if (!line_.empty()) line_ += style_.separator;
    line_ += value;
    return *this;
  }
  Line& number(double value) {
    std::string digits = csv_number(value);
    std::replace(digits.begin(), digits.end(), '.', style_.decimal);
    return text(digits);
  }
  [[nodiscard]] std::string done() const { return line_ + "\n"; }

 private:
  const TableStyle& style_;
  std::string line_;
};

}  // namespace

std::string long_csv(const RunTable& table, const TableStyle& style) {
  Line head(style);
  for (const char* column : {"frame", "time_s", "marker", "dx_mm", "dy_mm", "u_dx_mm", "u_dy_mm", "status"})
    head.text(column);
  std::string text = head.done();
  for (const Sample& s : table.samples) {
    Line line(style);
    line.text(fmt::format("{}", s.frame)).number(s.time_s).text(csv_field(table.markers[s.marker].name));
    line.number(s.displacement.x).number(s.displacement.y).number(s.u.x).number(s.u.y).text(word_for(s.status));
    text += line.done();
  }
  return text;
}

std::vector<WideRow> wide_rows(const RunTable& table) {
  std::vector<WideRow> rows;
  for (const Sample& sample : table.samples) {
    if (rows.empty() || rows.back().frame != sample.frame)
      rows.push_back({sample.frame, sample.time_s, std::vector<const Sample*>(table.markers.size())});
    rows.back().samples[sample.marker] = &sample;
  }
  return rows;
}

std::vector<WideColumn> wide_columns(const TableStyle& style) {
  std::vector<WideColumn> columns;
  if (style.has_x) columns.push_back({"dx_mm", [](const Sample& s) { return s.displacement.x; }});
  if (style.has_y) columns.push_back({"dy_mm", [](const Sample& s) { return s.displacement.y; }});
  if (style.has_x) columns.push_back({"u_dx_mm", [](const Sample& s) { return s.u.x; }});
  if (style.has_y) columns.push_back({"u_dy_mm", [](const Sample& s) { return s.u.y; }});
  return columns;
}

std::string wide_csv(const RunTable& table, const TableStyle& style) {
  const std::vector<WideColumn> columns = wide_columns(style);
  Line head(style);
  head.text("frame").text("time_s");
  for (const TableMarker& marker : table.markers) {
    for (const WideColumn& column : columns) head.text(csv_field(marker.name + "_" + column.name));
    head.text(csv_field(marker.name + "_ok"));
  }
  std::string text = head.done();
  for (const WideRow& row : wide_rows(table)) {
    Line line(style);
    line.text(fmt::format("{}", row.frame)).number(row.time_s);
    for (const Sample* s : row.samples) {
      for (const WideColumn& column : columns) line.number(s == nullptr ? kNotMeasured : column.value(*s));
      line.text(s != nullptr && s->status == Status::kOk ? "1" : "0");
    }
    text += line.done();
  }
  return text;
}

}  // namespace moiregauge::internal
