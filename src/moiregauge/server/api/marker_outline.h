// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "moiregauge/geometry/view.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal {

// Returns the corners of a grating in a view, px, for a grating that is displaced by `shift` on the board (mm).
[[nodiscard]] nlohmann::ordered_json grating_outline(const View& view, const Grating& grating,
                                                     Extent<frame::Board> shift);

}  // namespace moiregauge::internal
