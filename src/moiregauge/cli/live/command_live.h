// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

namespace moiregauge::internal::cli {

// Registers `moiregauge live`; running it sets exit_code.
void add_live(CLI::App& app, int& exit_code);

}  // namespace moiregauge::internal::cli
