// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/pictures/exif_orientation.h"

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace moiregauge::internal {
namespace {

// Reads numbers of either byte order. Beyond the end of the block they are 0.
struct TiffBlock {
  std::span<const std::uint8_t> bytes;
  bool big_endian = false;

  [[nodiscard]] std::uint32_t number(std::size_t at, std::size_t size) const {
    if (at > bytes.size() || size > bytes.size() - at) return 0;
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < size; ++i) value = value << 8U | bytes[at + (big_endian ? i : size - 1 - i)];
    return value;
  }
};

}  // namespace

int exif_orientation(std::span<const std::uint8_t> app1) {
  constexpr std::string_view kHead("Exif\0\0", 6);
  if (app1.size() < kHead.size() + 8 || !std::equal(kHead.begin(), kHead.end(), app1.begin())) return 1;
  const TiffBlock block{app1.subspan(kHead.size()), app1[kHead.size()] == 'M'};
  const std::size_t directory = block.number(4, 4);
  const std::uint32_t entries = block.number(directory, 2);
  for (std::size_t i = 0; i < entries; ++i) {
    const std::size_t entry = directory + 2 + 12 * i;
    if (block.number(entry, 2) == 0x0112) return static_cast<int>(block.number(entry + 8, 2));
  }
  return 1;
}

std::optional<int> rotation_of_orientation(int orientation) {
  switch (orientation) {
    case 2:
    case 4:
    case 5:
    case 7:
      return std::nullopt;
    case 3:
      return 180;
    case 6:
      return 90;
    case 8:
      return 270;
    default:
      return 0;  // 1, and values that the standard does not define
  }
}

}  // namespace moiregauge::internal
