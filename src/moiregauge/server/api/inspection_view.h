// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "moiregauge/io/run_dir/inspect_json.h"

namespace moiregauge::internal {

// Names of the markers that an inspection without a choice finds, with their positions.
using NamedPositions = std::vector<std::pair<std::string, ImagePoint>>;
[[nodiscard]] NamedPositions named_positions(const Inspection& seen);

// Returns what the page draws of an inspection: outlines and names of all objects, the scale, distances between the
// references, and the expected uncertainties. Positions are px of the image as displayed.
// `ignored`: markers that the user's choice excludes.
[[nodiscard]] nlohmann::ordered_json inspection_view(const InspectReport& report, const NamedPositions& ignored);

}  // namespace moiregauge::internal
