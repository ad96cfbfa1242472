// SPDX-License-Identifier: Apache-2.0
// What to tell someone who typed nothing, or something the program has not.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace moiregauge::internal::cli {

// What to type next, for `moiregauge` alone: the way from print to result, by the commands the tree has.
[[nodiscard]] std::string first_text(const CLI::App& app);

// One line, "what: where: what to do", about a command line that `app` has just refused. A word that is nearly one of
// the program's names it.
[[nodiscard]] std::string usage_mistake(const CLI::App& app, const CLI::ParseError& error);

}  // namespace moiregauge::internal::cli
