// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/folder/series_columns.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>

#include "moiregauge/displacement/sample.h"

namespace moiregauge::internal {
namespace {

constexpr std::int64_t kMaxSeriesCsv = std::int64_t{2} << 30;  // bytes
constexpr std::size_t kSeriesPiece = 4 << 20;                  // bytes of one read
constexpr std::size_t kMarkerField = 2, kStatusField = 7, kSeriesFields = 8;
static_assert(std::endian::native == std::endian::little, "the page reads little-endian numbers");

double series_number(std::string_view text) {
  double value = std::nan("");
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

double status_index(std::string_view word) {
  for (int i = 0; i <= static_cast<int>(Status::kTooCoarse); ++i) {
    if (word == word_for(static_cast<Status>(i))) return i;
  }
  return std::nan("");
}

std::array<std::string_view, kSeriesFields> fields_of(std::string_view line) {
  std::array<std::string_view, kSeriesFields> fields;
  for (std::string_view& field : fields) {
    const std::size_t comma = std::min(line.find(','), line.size());
    field = line.substr(0, comma);
    line.remove_prefix(std::min(comma + 1, line.size()));
  }
  return fields;
}

void add_series_row(std::string_view line, std::string_view marker, SeriesColumns& columns) {
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  const auto fields = fields_of(line);
  if (fields[kMarkerField] != marker) return;
  std::size_t column = 0;
  for (const std::size_t field : {0, 1, 3, 4, 5, 6}) columns.values[column++].push_back(series_number(fields[field]));
  columns.values[column].push_back(status_index(fields[kStatusField]));
}

// Returns the marker of the first row.
std::string first_marker(std::string_view lines) {
  const std::size_t second = std::min(lines.find('\n'), lines.size() - 1) + 1;
  const std::string_view rest = lines.substr(std::min(second, lines.size()));
  return std::string(fields_of(rest.substr(0, std::min(rest.find('\n'), rest.size())))[kMarkerField]);
}

}  // namespace

std::string SeriesColumns::bytes() const {
  std::string out;
  out.reserve(values.size() * rows() * sizeof(double));
  for (const std::vector<double>& column : values)
    out.append(reinterpret_cast<const char*>(column.data()), column.size() * sizeof(double));
  return out;
}

void add_series_rows(std::string_view lines, std::string_view marker, SeriesColumns& columns) {
  while (!lines.empty()) {
    const std::size_t end = std::min(lines.find('\n'), lines.size());
    add_series_row(lines.substr(0, end), marker, columns);
    lines.remove_prefix(std::min(end + 1, lines.size()));
  }
}

tl::expected<SeriesColumns, std::string> read_series(const std::string& displacement_csv, std::string marker) {
  std::ifstream in(displacement_csv, std::ios::binary | std::ios::ate);
  if (!in || in.tellg() > kMaxSeriesCsv)
    return tl::unexpected("the samples cannot be read: " + displacement_csv + ": measure the clip again");
  in.seekg(0);
  SeriesColumns columns;
  std::string text;
  std::vector<char> piece(kSeriesPiece);
  while (in.read(piece.data(), static_cast<std::streamsize>(piece.size())), in.gcount() > 0) {
    text.append(piece.data(), static_cast<std::size_t>(in.gcount()));
    const std::size_t whole = text.rfind('\n') + 1;  // 0 if there is no line end
    if (marker.empty() && whole > 0) marker = first_marker(text);
    add_series_rows(std::string_view(text).substr(0, whole), marker, columns);
    text.erase(0, whole);
  }
  add_series_rows(text, marker, columns);
  return columns;
}

}  // namespace moiregauge::internal
