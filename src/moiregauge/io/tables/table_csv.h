// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "moiregauge/io/tables/run_table.h"

namespace moiregauge::internal {

// Returns the table in the form of displacement.csv: one row per frame and target.
[[nodiscard]] std::string long_csv(const RunTable& table);

// Returns one row per frame: frame,time_s, then NAME_dx_mm,NAME_dy_mm,NAME_u_dx_mm,NAME_u_dy_mm,NAME_ok (1 or 0) of
// every target. All cells are numbers, so matrix readers accept it. Missing values are NaN.
[[nodiscard]] std::string wide_csv(const RunTable& table);

}  // namespace moiregauge::internal
