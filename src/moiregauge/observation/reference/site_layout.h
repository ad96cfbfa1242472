// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "moiregauge/site/site.h"

namespace moiregauge::internal {

// Returns the text on a site whose reference circles (four or more) are on a line, which determines no homography.
// Returns nothing for any other site.
[[nodiscard]] std::optional<std::string> references_on_a_line(const Site& site);

}  // namespace moiregauge::internal
