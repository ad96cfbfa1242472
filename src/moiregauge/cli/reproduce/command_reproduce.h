// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

namespace moiregauge::internal::cli {

// Adds `moiregauge reproduce` (docs/cli/reproduce.md). A run stores its exit code in exit_code, which must outlive app.
void add_reproduce(CLI::App& app, int& exit_code);

}  // namespace moiregauge::internal::cli
