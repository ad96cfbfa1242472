// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

namespace moiregauge::internal::cli {

// Registers `moiregauge serve`; running it sets exit_code.
void add_serve(CLI::App& app, int& exit_code);

}  // namespace moiregauge::internal::cli
