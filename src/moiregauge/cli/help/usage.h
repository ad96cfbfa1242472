// SPDX-License-Identifier: Apache-2.0
// Creates help for a missing or wrong command line.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace moiregauge::internal::cli {

// Returns the text of `moiregauge` without arguments: the steps from printing to results, for the commands that exist.
[[nodiscard]] std::string first_text(const CLI::App& app);

// Returns one line, "what happened: where: what to do", on the command line that `app` refused. It suggests the nearest
// known name.
[[nodiscard]] std::string usage_mistake(const CLI::App& app, const CLI::ParseError& error);

}  // namespace moiregauge::internal::cli
