// SPDX-License-Identifier: Apache-2.0
// Draws overlay.png of `inspect`: the image with all detected objects, and a legend below.
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
  std::string caption;  // name of the image
};

// Returns the bytes of a PNG file. Small images are enlarged by an integer factor. Empty if cairo is out of memory.
[[nodiscard]] std::vector<std::uint8_t> draw_inspection(const InspectionOverlay& contents);

}  // namespace moiregauge::internal
