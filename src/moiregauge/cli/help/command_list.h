// SPDX-License-Identifier: Apache-2.0
// The commands of a tree, for help, completion and error lines.
#pragma once

#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

namespace moiregauge::internal::cli {

// The parser's message about an option with an empty text.
inline constexpr std::string_view kEmptyValue = "the value is empty";

// Returns the commands that help lists, in the order of the tree.
[[nodiscard]] inline std::vector<const CLI::App*> visible_commands(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* command) { return !command->get_group().empty(); });
}

}  // namespace moiregauge::internal::cli
