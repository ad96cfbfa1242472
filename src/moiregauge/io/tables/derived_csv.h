// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "moiregauge/results/derived/derived_table.h"

namespace moiregauge::internal {

// Returns derived.csv (docs/file-formats.md): a header line, then one row per frame. Values have nine digits, NaN if
// there is none.
[[nodiscard]] std::string derived_csv(const DerivedTable& table);

// Returns a channel's column of derived.csv: name and unit, such as sag_mm or e_um_per_m.
[[nodiscard]] std::string column_name(const std::string& name, const std::string& unit);

}  // namespace moiregauge::internal
