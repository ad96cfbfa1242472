// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "moiregauge/displacement/method.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal {

// displacement.csv (docs/file-formats.md): header on line 1, one row per frame and target, NaN for what was not measured,
// six decimals: nanometres and microseconds.
[[nodiscard]] std::string displacement_csv(const Site& site, const Samples& samples);

}  // namespace moiregauge::internal
