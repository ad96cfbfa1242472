// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "moiregauge/site/site.h"

namespace moiregauge::internal {

// Returns a note if the reference circles and their diameters map onto themselves, within what identification
// distinguishes, by a mirror image or a half turn. No picture of such a layout shows whether it was mirrored or turned.
[[nodiscard]] std::optional<std::string> symmetry_note(const Site& site);

}  // namespace moiregauge::internal
