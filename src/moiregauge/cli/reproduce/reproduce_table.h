// SPDX-License-Identifier: Apache-2.0
// Returns the errors measured by `reproduce` next to those of the paper, as Markdown.
#pragma once

#include <string>

#include "moiregauge/cli/reproduce/reproduce_run.h"

namespace moiregauge::internal::cli {

[[nodiscard]] std::string reproduce_table(const ReproducePlan& plan, const std::vector<CellRun>& cells, bool quick);

}  // namespace moiregauge::internal::cli
