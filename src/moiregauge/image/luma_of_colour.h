// SPDX-License-Identifier: Apache-2.0
// The one formula from colour to grey (docs/conventions.md), in integers so that every door gives the same bits.
#pragma once

#include <cstdint>

namespace moiregauge::internal {

// Weights 0.301, 0.586, 0.113 of 256; at 16 bits the sum stays below 2^24.
template <typename Grey>
[[nodiscard]] constexpr Grey luma_of_colour(Grey red, Grey green, Grey blue) {
  return static_cast<Grey>(
      (77U * std::uint32_t{red} + 150U * std::uint32_t{green} + 29U * std::uint32_t{blue} + 128U) >> 8U);
}
static_assert(luma_of_colour<std::uint8_t>(255, 255, 255) == 255, "white stays white");

}  // namespace moiregauge::internal
