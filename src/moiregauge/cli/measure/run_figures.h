// SPDX-License-Identifier: Apache-2.0
// --figures of `measure` and `solve`: DIR/figures, one file per figure and format.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "moiregauge/cli/common/measure_options.h"
#include "moiregauge/io/run_dir/run_directory.h"

namespace moiregauge::internal::cli {

void add_figures(CLI::App& command, std::string& word);

// "pdf", "pdf,svg"; none of an empty word.
[[nodiscard]] tl::expected<std::vector<std::string>, UsageError> figure_formats(const std::string& word);

// What a run cannot show is left out, with a note on stderr.
[[nodiscard]] PutMore put_figures(std::vector<std::string> formats, bool quiet);

}  // namespace moiregauge::internal::cli
