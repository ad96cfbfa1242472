// SPDX-License-Identifier: Apache-2.0
// overlay.png: the reference frame with every marker drawn where it was found.
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

// The bytes of a PNG file. Empty when cairo cannot make one (out of memory).
[[nodiscard]] std::vector<std::uint8_t> draw_overlay(const OverlayContents& contents);

}  // namespace moiregauge::internal
