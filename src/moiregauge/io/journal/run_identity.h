// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "moiregauge/io/journal/run_file.h"

namespace moiregauge::internal {

// Compares an unfinished run with this input and these options. Returns nothing if resuming gives the same result as an
// uninterrupted run, otherwise the difference. Number of threads, output folder and printed output do not matter.
[[nodiscard]] std::optional<std::string> difference(const StoredRun& kept, const RunStart& start,
                                                    const MeasureOptions& options);

}  // namespace moiregauge::internal
