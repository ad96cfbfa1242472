// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

namespace moiregauge::internal::cli {

// Adds `moiregauge sheet` (docs/cli/sheet.md).
void add_sheet(CLI::App& app, int& exit_code);

}  // namespace moiregauge::internal::cli
