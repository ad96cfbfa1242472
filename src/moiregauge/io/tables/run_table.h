// SPDX-License-Identifier: Apache-2.0
// The numbers of a finished run as they lie in its folder, whatever version of the program wrote them:
// displacement.csv, and what run.json says of it. For handing them on; nothing is computed anew.
#pragma once

#include <istream>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/displacement/sample.h"
#include "moiregauge/units/point.h"

namespace moiregauge::internal {

struct TableMarker {
  std::string name;
  BoardPoint place{};  // mm; 0 where run.json does not say
  double z_mm = 0.0;
};

struct RunTable {
  std::string version;  // of the program that measured
  std::string method;
  std::string input, input_sha256;
  long reference_frame = 0;
  bool complete = true;              // false: interrupted, or a damaged input
  std::vector<TableMarker> markers;  // the targets
  std::vector<Sample> samples;       // in the file's order; `marker` is an index into `markers`, budgets are empty
};

// The two files of a folder. Fails with "what: where: what to do": no such folder, a run that is under way or was
// refused, files that are damaged or not ours.
[[nodiscard]] tl::expected<RunTable, std::string> read_run_table(const std::string& dir);

// Of displacement.csv alone, into `table`. Fails with "line N: what is wrong". Columns after the eighth are left alone.
[[nodiscard]] tl::expected<void, std::string> parse_displacement_csv(std::istream& csv, RunTable& table);

// What `export` takes of a run.
struct Selection {
  std::vector<std::string> markers;       // empty: all
  std::optional<double> from_s, until_s;  // half open
  bool only_ok = false;                   // numbers of rows that are not `ok` become NaN
};
// Fails with "what: where: what to do": a marker that is not there, a time range of a run without time, nothing left.
[[nodiscard]] tl::expected<RunTable, std::string> selected(RunTable table, const Selection& selection);

}  // namespace moiregauge::internal
