// SPDX-License-Identifier: Apache-2.0
// Columns of one target from a displacement.csv, as numbers for the page.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

namespace moiregauge::internal {

inline constexpr std::array<std::string_view, 7> kSeriesColumns = {"frame", "time_s", "dx",    "dy",
                                                                   "u_dx",  "u_dy",   "status"};

// Rows of one target. A status is its index in the list of docs/file-formats.md.
struct SeriesColumns {
  std::array<std::vector<double>, kSeriesColumns.size()> values;
  [[nodiscard]] std::size_t rows() const { return values.front().size(); }
  // Returns all columns one after the other, as little-endian doubles.
  [[nodiscard]] std::string bytes() const;
};

// Adds the rows of a marker in a text of whole lines. Other lines are skipped.
void add_series_rows(std::string_view lines, std::string_view marker, SeriesColumns& columns);

// Reads a marker's rows. An empty marker: the first one of the file. Fails with "what: where: what to do": the file is
// missing, or longer than 2 GB.
[[nodiscard]] tl::expected<SeriesColumns, std::string> read_series(const std::string& displacement_csv,
                                                                   std::string marker);

}  // namespace moiregauge::internal
