// SPDX-License-Identifier: Apache-2.0
// `moiregauge compare`.
#pragma once

#include <CLI/CLI.hpp>

namespace moiregauge::internal::cli {

void add_compare(CLI::App& app, int& exit_code);

}  // namespace moiregauge::internal::cli
