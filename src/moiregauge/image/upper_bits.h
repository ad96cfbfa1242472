// SPDX-License-Identifier: Apache-2.0
// Conversion of an image of any depth for display.
#pragma once

#include <algorithm>
#include <cstdint>
#include <variant>

#include "moiregauge/image/image.h"

namespace moiregauge::internal {

// Returns the upper eight of the `bits` significant bits.
[[nodiscard]] inline Image<std::uint8_t> upper_bits(const LumaView& luma, int bits) {
  Image<std::uint8_t> out(width_of(luma), height_of(luma));
  std::visit(
      [&](const auto& view) {
        for (int y = 0; y < view.height; ++y) {
          const auto from = view.row(y);
          std::transform(from.begin(), from.end(), out.row(y).begin(),
                         [bits](auto grey) { return static_cast<std::uint8_t>(grey >> (bits - 8)); });
        }
      },
      luma);
  return out;
}

}  // namespace moiregauge::internal
