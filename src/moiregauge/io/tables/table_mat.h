// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "moiregauge/io/tables/table_csv.h"

namespace moiregauge::internal {

// Returns a MAT file (version 5) for MATLAB and Octave. It has the columns `frame` and `time_s`, and a struct array
// `targets` with `name`, the columns of the style, and `ok`. Missing values are NaN. The same table gives the same bytes. Empty if it
// cannot be written.
[[nodiscard]] std::string table_mat(const RunTable& table, const TableStyle& style);

}  // namespace moiregauge::internal
