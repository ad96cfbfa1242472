// SPDX-License-Identifier: Apache-2.0
// `moiregauge completion bash|zsh`: what a shell needs to complete the program's words. Not listed: packages install
// it.
#pragma once

#include <CLI/CLI.hpp>

namespace moiregauge::internal::cli {

void add_completion(CLI::App& app, int& exit_code);

}  // namespace moiregauge::internal::cli
