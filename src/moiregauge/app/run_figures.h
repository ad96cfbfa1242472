// SPDX-License-Identifier: Apache-2.0
// --figures of `measure` and `solve`: DIR/figures, one file per figure and format.
#pragma once

#include <string>
#include <vector>

#include "moiregauge/app/measure_options.h"
#include "moiregauge/app/run_progress.h"
#include "moiregauge/io/run_dir/run_directory.h"

namespace moiregauge::internal {

// Reads "pdf" or "pdf,svg"; no formats of an empty text. Fails for any other word.
[[nodiscard]] tl::expected<std::vector<std::string>, UsageError> figure_formats(const std::string& text);

// Returns the writer of the figures. A figure that the run cannot show is skipped with a note. `callbacks` must outlive
// the writer.
[[nodiscard]] PutMore put_figures(std::vector<std::string> formats, const RunCallbacks& callbacks);

}  // namespace moiregauge::internal
