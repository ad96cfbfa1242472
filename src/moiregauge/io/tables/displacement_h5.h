// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "moiregauge/io/tables/run_table.h"
#include "moiregauge/run/measure.h"

namespace moiregauge::internal {

// displacement.h5 (docs/file-formats.md): the numbers of displacement.csv to their last bit, a group per target. The
// same measurement gives the same bytes. Needs a reference frame; empty when the library fails, which takes a lack of
// memory.
[[nodiscard]] std::string displacement_h5(const Measurement& measurement, const MeasureOptions& options);

// The same of what was read back.
[[nodiscard]] std::string displacement_h5(const RunTable& table);

}  // namespace moiregauge::internal
