// SPDX-License-Identifier: Apache-2.0
// overlay.png of `inspect`: the picture with everything that was seen in it, and a legend below.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "moiregauge/displacement/expected_uncertainty.h"
#include "moiregauge/observation/views/inspection.h"

namespace moiregauge::internal {

struct InspectionOverlay {
  ImageView<std::uint8_t> picture;
  const Inspection& seen;
  std::span<const ExpectedUncertainty> expected;
  std::string caption;  // which picture this is
};

// The bytes of a PNG file; small pictures are enlarged by a whole number. Empty when cairo cannot make one.
[[nodiscard]] std::vector<std::uint8_t> draw_inspection(const InspectionOverlay& contents);

}  // namespace moiregauge::internal
