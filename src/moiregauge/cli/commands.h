// SPDX-License-Identifier: Apache-2.0
// The program's commands as one tree of options: main parses it, completion and the tests of the pages read it.
#pragma once

#include <memory>

#include <CLI/CLI.hpp>

namespace moiregauge::internal::cli {

// The parser throws it at --self-test.
class CallForSelfTest : public CLI::Success {};

// Returns the tree of commands. -h lists the options, --help shows the command's page (page.h); parsing throws a
// different exception for each. A command that ran sets `exit_code`, which must outlive the tree.
[[nodiscard]] std::unique_ptr<CLI::App> command_tree(int& exit_code);
}  // namespace moiregauge::internal::cli
