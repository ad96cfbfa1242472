// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "moiregauge/io/run_dir/inspect_json.h"

namespace moiregauge::internal {

// Returns what the page draws of an inspection: outlines and names of all objects, the scale, distances between the
// references, and the expected uncertainties. Positions are px of the image as displayed.
[[nodiscard]] nlohmann::ordered_json inspection_view(const InspectReport& report);

}  // namespace moiregauge::internal
