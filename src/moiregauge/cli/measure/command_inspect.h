// SPDX-License-Identifier: Apache-2.0
// `moiregauge inspect`: everything that is detected in one frame (docs/cli/inspect.md).
#pragma once

#include <CLI/CLI.hpp>

namespace moiregauge::internal::cli {

void add_inspect(CLI::App& app, int& exit_code);

}  // namespace moiregauge::internal::cli
