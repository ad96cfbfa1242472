// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

namespace moiregauge::internal::cli {

// Adds `moiregauge simulate`. A run sets exit_code.
void add_simulate(CLI::App& app, int& exit_code);

}  // namespace moiregauge::internal::cli
