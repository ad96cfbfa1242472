// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

namespace moiregauge::internal::cli {

// Adds `moiregauge plan` (docs/cli/plan.md).
void add_plan(CLI::App& app, int& exit_code);

}  // namespace moiregauge::internal::cli
