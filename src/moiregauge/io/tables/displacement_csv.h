// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "moiregauge/displacement/method.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal {

// Returns displacement.csv (docs/file-formats.md): a header line, then one row per frame and target. Values have six
// decimals (nm, µs), NaN if not measured.
[[nodiscard]] std::string displacement_csv(const Site& site, const Samples& samples);

}  // namespace moiregauge::internal
