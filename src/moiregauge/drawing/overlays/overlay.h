// SPDX-License-Identifier: Apache-2.0
// Draws overlay.png: the reference frame with every marker outlined at its detected position.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "moiregauge/image/image.h"
#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

struct OverlayContents {
  ImageView<std::uint8_t> picture;
  const Reference* reference = nullptr;  // nullptr: nothing was identified
  std::string caption;                   // one line at the top
};

// Returns the bytes of a PNG file. Empty if cairo is out of memory.
[[nodiscard]] std::vector<std::uint8_t> draw_overlay(const OverlayContents& contents);

}  // namespace moiregauge::internal
