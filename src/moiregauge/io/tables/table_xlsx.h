// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "moiregauge/io/tables/table_csv.h"

namespace moiregauge::internal {

// Returns a workbook: sheet `displacement` is the wide table, sheet `run` states its origin. Missing values are #N/A,
// because a cell has no NaN. The same table gives the same bytes. Empty if it cannot be written.
[[nodiscard]] std::string table_xlsx(const RunTable& table, const TableStyle& style);

}  // namespace moiregauge::internal
