// SPDX-License-Identifier: Apache-2.0
// What `reproduce` measured beside what the paper reports, as Markdown.
#pragma once

#include <string>

#include "moiregauge/cli/reproduce/reproduce_run.h"

namespace moiregauge::internal::cli {

[[nodiscard]] std::string reproduce_table(const ReproducePlan& plan, const std::vector<CellRun>& cells, bool quick);

}  // namespace moiregauge::internal::cli
