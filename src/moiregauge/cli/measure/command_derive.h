// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

namespace moiregauge::internal::cli {

void add_derive(CLI::App& app, int& exit_code);

}  // namespace moiregauge::internal::cli
