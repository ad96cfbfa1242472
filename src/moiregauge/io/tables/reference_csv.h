// SPDX-License-Identifier: Apache-2.0
// Reads the record of another sensor from a CSV file of any data logger.
#pragma once

#include <istream>
#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "moiregauge/results/series.h"

namespace moiregauge::internal {

// Columns by number (the first is 1) or by the name in a header line.
struct ReferenceColumns {
  std::string time = "1";
  std::string value = "2";
  std::optional<double> rate_hz;  // the rows have this rate, and there is no column of times
  std::string time_unit;          // s, ms, us, min or h; empty: the one in the column's name, otherwise s
};

struct ReferenceRecord {
  Series series;          // times in s, values as written
  std::string time_unit;  // by the header; empty: s, or another source
};

struct ReferenceMistake {
  bool is_usage = false;  // an option is wrong, not the file
  std::string message;    // "what happened: where: what to do"
};

// Limits (chosen). They bound memory and time for any file.
inline constexpr std::size_t kMaxReferenceLine = std::size_t{1} << 16;  // bytes
inline constexpr std::size_t kMaxReferenceRows = 5'000'000;
inline constexpr std::size_t kMaxHeaderLines = 50;

// Reads times and values. A time is a number, a date with a time of day, or a time of day (time_cell.h). The last two
// count from the first row, and a time of day may pass midnight. Separator: tab, semicolon or comma, by the first row. A decimal comma is
// read with other separators, or in quotes. Empty lines and lines that begin with # or % or // are skipped, and so are
// header lines. An empty value or NaN is a gap.
// Fails: no such column, a cell that is no number, times that do not increase, UTF-16, limits. `path` is for messages.
[[nodiscard]] tl::expected<ReferenceRecord, ReferenceMistake> parse_reference_csv(std::istream& csv,
                                                                                  const std::string& path,
                                                                                  const ReferenceColumns& columns);

// Reads a file. Also fails: it does not exist, or is no plain file.
[[nodiscard]] tl::expected<ReferenceRecord, ReferenceMistake> read_reference_csv(const std::string& path,
                                                                                 const ReferenceColumns& columns);

}  // namespace moiregauge::internal
