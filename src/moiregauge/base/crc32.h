// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace moiregauge::internal {

// Returns the check sum of PNG, gzip and Ethernet (polynomial 0x04C11DB7, reflected). It detects every burst error of
// up to 32 bits. `so_far` is the check sum of the bytes before these.
[[nodiscard]] inline std::uint32_t crc32(std::string_view bytes, std::uint32_t so_far = 0) {
  static constexpr auto kTable = [] {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t n = 0; n < 256; ++n) {
      std::uint32_t c = n;
      for (int bit = 0; bit < 8; ++bit) c = (c & 1U) != 0U ? 0xEDB88320U ^ (c >> 1U) : c >> 1U;
      table[n] = c;
    }
    return table;
  }();
  std::uint32_t c = ~so_far;
  for (const char byte : bytes) c = kTable[(c ^ static_cast<std::uint8_t>(byte)) & 0xFFU] ^ (c >> 8U);
  return ~c;
}

}  // namespace moiregauge::internal
