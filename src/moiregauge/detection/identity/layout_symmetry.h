// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "moiregauge/site/site.h"

namespace moiregauge::internal {

// Returns a note if a mirror image or a half turn maps the reference circles onto themselves, within the tolerance of
// the identification. An image of such a layout does not show whether it was mirrored or rotated.
[[nodiscard]] std::optional<std::string> symmetry_note(const Site& site);

}  // namespace moiregauge::internal
