// SPDX-License-Identifier: Apache-2.0
#include "floor_pass.h"

#include <array>
#include <cstring>

namespace moiregauge::bench {

// Sums of eight bytes at a time, in lanes of their own: no addition waits for another, and every instruction set's
// vectors do it as fast as memory delivers.
std::uint64_t floor_pass(std::span<const std::uint8_t> bytes) {
  std::array<std::uint64_t, 16> lanes{};
  std::size_t i = 0;
  for (; i + sizeof lanes <= bytes.size(); i += sizeof lanes) {
    std::array<std::uint64_t, 16> words;
    std::memcpy(words.data(), bytes.data() + i, sizeof words);
    for (std::size_t k = 0; k < lanes.size(); ++k) lanes[k] += words[k];
  }
  std::uint64_t sum = 0;
  for (const std::uint64_t lane : lanes) sum += lane;
  for (; i < bytes.size(); ++i) sum += bytes[i];
  return sum;
}

}  // namespace moiregauge::bench
