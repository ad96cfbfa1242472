// SPDX-License-Identifier: Apache-2.0
// Adds `moiregauge help`, which shows the page of a command.
#pragma once

#include <string_view>

#include <CLI/CLI.hpp>

namespace moiregauge::internal::cli {

// Prints the page as wide as the terminal. Prints nothing for a command without a page.
void show_page(std::string_view name);

void add_help(CLI::App& app, int& exit_code);

}  // namespace moiregauge::internal::cli
