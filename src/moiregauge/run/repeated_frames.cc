// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/run/repeated_frames.h"

#include <cstring>
#include <utility>
#include <variant>

namespace moiregauge::internal {
namespace {

constexpr int kRowStep = 16;

// Adds eight bytes at a time. Each step is invertible, so frames that differ in a single word always have different
// hashes.
std::uint64_t mixed(std::uint64_t hash, const std::byte* bytes, std::size_t size) {
  for (; size >= sizeof(std::uint64_t); bytes += sizeof(std::uint64_t), size -= sizeof(std::uint64_t)) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes, sizeof word);
    hash = (hash ^ word) * 0x9E3779B97F4A7C15U;
    hash ^= hash >> 32U;
  }
  for (; size > 0; ++bytes, --size) hash = (hash ^ static_cast<std::uint64_t>(*bytes)) * 0x9E3779B97F4A7C15U;
  return hash;
}

}  // namespace

bool RepeatedFrames::repeats(const LumaView& luma) {
  std::uint64_t hash = 1;
  std::visit(
      [&](const auto& picture) {
        for (int y = kRowStep / 2; y < picture.height; y += kRowStep) {
          const auto row = picture.row(y);
          hash = mixed(hash, reinterpret_cast<const std::byte*>(row.data()), row.size_bytes());
        }
      },
      luma);
  return std::exchange(last_, hash) == hash;
}

}  // namespace moiregauge::internal
