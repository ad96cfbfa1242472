// SPDX-License-Identifier: Apache-2.0
// `moiregauge help`: the page of a command.
#pragma once

#include <string_view>

#include <CLI/CLI.hpp>

namespace moiregauge::internal::cli {

// On stdout, as wide as the terminal; of a command that has no page, nothing.
void show_page(std::string_view name);

void add_help(CLI::App& app, int& exit_code);

}  // namespace moiregauge::internal::cli
