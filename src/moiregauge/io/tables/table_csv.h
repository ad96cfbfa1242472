// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "moiregauge/io/tables/run_table.h"

namespace moiregauge::internal {

// As displacement.csv: a row per frame and target.
[[nodiscard]] std::string long_csv(const RunTable& table);

// A row per frame: frame,time_s, then of every target NAME_dx_mm,NAME_dy_mm,NAME_u_dx_mm,NAME_u_dy_mm,NAME_ok (1 or 0).
// All numbers, so that a reader of matrices takes it; NaN for what is not there.
[[nodiscard]] std::string wide_csv(const RunTable& table);

}  // namespace moiregauge::internal
