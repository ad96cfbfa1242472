// SPDX-License-Identifier: Apache-2.0
// Reads the results of a finished run from its folder, for any version of the program: displacement.csv and run.json.
// They are for export: nothing is computed again.
#pragma once

#include <istream>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/displacement/sample.h"
#include "moiregauge/io/tables/camera_csv.h"
#include "moiregauge/units/frame_range.h"
#include "moiregauge/units/point.h"

namespace moiregauge::internal {

struct TableMarker {
  std::string name;
  BoardPoint place{};  // mm; 0 if run.json has none
  double z_mm = 0.0;
};

struct RunTable {
  std::string version;  // version that measured
  std::string method;
  std::string input, input_sha256;
  long reference_frame = 0;
  bool complete = true;              // false: interrupted run or damaged input
  std::vector<TableMarker> markers;  // targets
  std::vector<CameraRow> camera;     // by frame; empty: not stated, or read from files
  std::vector<Sample> samples;       // in file order; `marker` is an index into `markers`, budgets are empty
};

// Reads the two files of a folder. Fails with "what happened: where: what to do": no such folder, an unfinished or
// refused run, damaged or foreign files.
[[nodiscard]] tl::expected<RunTable, std::string> read_run_table(const std::string& dir);

// Reads displacement.csv into `table`. Fails with the line and the mistake. Columns after the eighth are ignored.
[[nodiscard]] tl::expected<void, std::string> parse_displacement_csv(std::istream& csv, RunTable& table);

// Part of a run to export.
struct Selection {
  std::vector<std::string> markers;  // empty: all
  FrameRange frames;                 // frames or seconds
  bool only_ok = false;              // values of samples that are not `ok` become NaN
};
// Selects samples. Fails with "what happened: where: what to do": unknown marker, a time range without times, an empty
// selection.
[[nodiscard]] tl::expected<RunTable, std::string> selected(RunTable table, const Selection& selection);

}  // namespace moiregauge::internal
