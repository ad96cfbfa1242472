// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "moiregauge/site/site.h"

namespace moiregauge::internal {

// What is wrong with a site whose four or more reference circles stand on a line: no homography follows from them.
[[nodiscard]] std::optional<std::string> references_on_a_line(const Site& site);

}  // namespace moiregauge::internal
