// SPDX-License-Identifier: Apache-2.0
#include "floor_pass.h"

#include <cstring>

namespace moiregauge::internal::bench {
namespace {

std::uint64_t word(const std::uint8_t* bytes) {
  std::uint64_t w = 0;
  std::memcpy(&w, bytes, sizeof w);
  return w;
}

}  // namespace

// Adds eight bytes at a time in four independent streams, so that no addition waits for another. The compiler
// vectorises this for any instruction set, and it is as fast as memory.
std::uint64_t floor_pass(std::span<const std::uint8_t> bytes) {
  const std::size_t stream = bytes.size() / (4 * sizeof(std::uint64_t)) * sizeof(std::uint64_t);
  const std::uint8_t* const p = bytes.data();
  std::uint64_t a = 0, b = 0, c = 0, d = 0;
  for (std::size_t i = 0; i < stream; i += sizeof(std::uint64_t)) {
    a += word(p + i);
    b += word(p + stream + i);
    c += word(p + 2 * stream + i);
    d += word(p + 3 * stream + i);
  }
  std::uint64_t sum = a + b + c + d;
  for (std::size_t i = 4 * stream; i < bytes.size(); ++i) sum += p[i];
  return sum;
}

}  // namespace moiregauge::internal::bench
