// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

namespace moiregauge::internal::cli {

// Registers `moiregauge batch`; running it sets exit_code.
void add_batch(CLI::App& app, int& exit_code);

}  // namespace moiregauge::internal::cli
