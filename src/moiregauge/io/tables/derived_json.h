// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "moiregauge/results/derived/derived_table.h"
#include "moiregauge/results/derived/statistics.h"

namespace moiregauge::internal {

// Returns derived.json (docs/file-formats.md): channels, layers in their order, and statistics.
[[nodiscard]] std::string derived_json(const DerivedTable& table, const std::vector<ChannelStatistics>& statistics,
                                       const std::vector<Layer>& layers);

}  // namespace moiregauge::internal
