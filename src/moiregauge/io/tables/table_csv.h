// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "moiregauge/io/tables/run_table.h"

namespace moiregauge::internal {

// Columns of a wide table, and the marks of its text.
struct TableStyle {
  bool has_x = true, has_y = true;
  char separator = ',';
  char decimal = '.';
};

// Returns the table in the form of displacement.csv: one row per frame and target. All columns are written.
[[nodiscard]] std::string long_csv(const RunTable& table, const TableStyle& style = {});

// Row of a wide table: one sample per target, nullptr if there is none.
struct WideRow {
  long frame = 0;
  double time_s = kNotMeasured;
  std::vector<const Sample*> samples;
};
// Returns the rows of a wide table. They refer to `table`.
[[nodiscard]] std::vector<WideRow> wide_rows(const RunTable& table);

// Numeric column of a target in a wide table: NAME_dx_mm and so on.
struct WideColumn {
  const char* name;  // "dx_mm"
  double (*value)(const Sample&);
};
// Returns the columns of one target, without `ok`.
[[nodiscard]] std::vector<WideColumn> wide_columns(const TableStyle& style);

// Returns one row per frame: frame,time_s, then NAME_dx_mm,NAME_dy_mm,NAME_u_dx_mm,NAME_u_dy_mm,NAME_ok (1 or 0) of
// every target. All cells are numbers, so matrix readers accept it. Missing values are NaN.
[[nodiscard]] std::string wide_csv(const RunTable& table, const TableStyle& style = {});

}  // namespace moiregauge::internal
