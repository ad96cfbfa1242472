// SPDX-License-Identifier: Apache-2.0
// A picture of any depth as one to look at.
#pragma once

#include <algorithm>
#include <cstdint>
#include <variant>

#include "moiregauge/image/image.h"

namespace moiregauge::internal {

// The upper eight of the `bits` that are significant.
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
