// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "moiregauge/batch/collected_clip.h"

namespace moiregauge::internal {

// Returns the header line of batch.csv.
[[nodiscard]] std::string batch_csv_header();

// Returns the rows of a clip: one for each target, or one without a marker.
[[nodiscard]] std::string batch_csv_rows(const CollectedClip& clip);

}  // namespace moiregauge::internal
