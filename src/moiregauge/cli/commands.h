// SPDX-License-Identifier: Apache-2.0
// The program's commands as one tree of options: main parses it, completion and the tests of the pages read it.
#pragma once

#include <memory>

#include <CLI/CLI.hpp>

namespace moiregauge::internal::cli {

// -h is the list of options, --help the command's page (pages.h); main tells the two by what parsing throws. A command
// that ran leaves its exit code in `exit_code`, which must outlive the tree.
[[nodiscard]] std::unique_ptr<CLI::App> command_tree(int& exit_code);
}  // namespace moiregauge::internal::cli
