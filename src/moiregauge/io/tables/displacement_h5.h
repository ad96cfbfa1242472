// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "moiregauge/io/tables/run_table.h"
#include "moiregauge/run/measure.h"

namespace moiregauge::internal {

// Returns displacement.h5 (docs/file-formats.md): the values of displacement.csv with all bits, one group per target.
// The same measurement gives the same bytes. Requires a reference frame. Empty if the library fails (out of memory).
[[nodiscard]] std::string displacement_h5(const Measurement& measurement, const MeasureOptions& options);

// Returns the same for a table that was read from files.
[[nodiscard]] std::string displacement_h5(const RunTable& table);

}  // namespace moiregauge::internal
