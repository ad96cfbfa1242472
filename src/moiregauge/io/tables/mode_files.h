// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "moiregauge/results/modes/mode_shapes.h"

namespace moiregauge::internal {

// Return modes.csv and modes.json (docs/file-formats.md). `names`: names of the targets.
[[nodiscard]] std::string modes_csv(const std::vector<ModeShape>& shapes, const std::vector<std::string>& names);
[[nodiscard]] std::string modes_json(const std::vector<ModeShape>& shapes, const std::vector<std::string>& names);

}  // namespace moiregauge::internal
