// SPDX-License-Identifier: Apache-2.0
// Conversion of colour to grey (docs/conventions.md). Integers give the same bits in every reader.
#pragma once

#include <cstdint>

namespace moiregauge::internal {

// Returns the luma of a colour. The weights are 0.301, 0.586 and 0.113, in units of 1/256. With 16 bits the sum is
// below 2^24.
template <typename Grey>
[[nodiscard]] constexpr Grey luma_of_colour(Grey red, Grey green, Grey blue) {
  return static_cast<Grey>(
      (77U * std::uint32_t{red} + 150U * std::uint32_t{green} + 29U * std::uint32_t{blue} + 128U) >> 8U);
}
static_assert(luma_of_colour<std::uint8_t>(255, 255, 255) == 255, "white stays white");

}  // namespace moiregauge::internal
