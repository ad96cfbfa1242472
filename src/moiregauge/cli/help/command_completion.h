// SPDX-License-Identifier: Apache-2.0
// Adds `moiregauge completion bash|zsh`, which prints the completion script of a shell. Not listed in the help, because
// packages install it.
#pragma once

#include <CLI/CLI.hpp>

namespace moiregauge::internal::cli {

void add_completion(CLI::App& app, int& exit_code);

}  // namespace moiregauge::internal::cli
