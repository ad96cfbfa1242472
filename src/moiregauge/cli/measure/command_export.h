// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

namespace moiregauge::internal::cli {

// `moiregauge export`: docs/cli/export.md.
void add_export(CLI::App& app, int& exit_code);

}  // namespace moiregauge::internal::cli
