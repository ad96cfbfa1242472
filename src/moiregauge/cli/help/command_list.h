// SPDX-License-Identifier: Apache-2.0
// Lists the commands of a program, for help, completion and error messages.
#pragma once

#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

namespace moiregauge::internal::cli {

// The parser's message for an option with an empty value.
inline constexpr std::string_view kEmptyValue = "the value is empty";

// Returns the commands that the help lists, in the program's order.
[[nodiscard]] inline std::vector<const CLI::App*> visible_commands(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* command) { return !command->get_group().empty(); });
}

}  // namespace moiregauge::internal::cli
