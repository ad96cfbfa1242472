// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/pictures/exif_orientation.h"

#include <algorithm>
#include <cstddef>
#include <string_view>

#include "moiregauge/base/utc_text.h"

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
  // Returns the place of the value of a tag in a directory. Nothing: it is not there.
  [[nodiscard]] std::optional<std::size_t> value_of(std::size_t directory, std::uint32_t tag) const {
    const std::uint32_t entries = number(directory, 2);
    for (std::size_t i = 0; i < entries; ++i) {
      const std::size_t entry = directory + 2 + 12 * i;
      if (number(entry, 2) == tag) return entry + 8;
    }
    return std::nullopt;
  }
  // Returns the letters of a tag, without the zero at their end.
  [[nodiscard]] std::string text_of(std::size_t directory, std::uint32_t tag) const {
    const auto value = value_of(directory, tag);
    if (!value) return {};
    constexpr std::size_t kInPlace = 4;  // bytes
    const std::size_t count = std::min<std::size_t>(number(*value - 4, 4), 64);
    const std::size_t at = count <= kInPlace ? *value : number(*value, 4);
    std::string text;
    for (std::size_t i = 0; i < count; ++i) text += static_cast<char>(number(at + i, 1));
    return text.substr(0, text.find('\0'));
  }
};

std::optional<TiffBlock> exif_block(std::span<const std::uint8_t> app1) {
  constexpr std::string_view kHead("Exif\0\0", 6);
  if (app1.size() < kHead.size() + 8 || !std::equal(kHead.begin(), kHead.end(), app1.begin())) return std::nullopt;
  return TiffBlock{app1.subspan(kHead.size()), app1[kHead.size()] == 'M'};
}

constexpr std::size_t kFirstDirectory = 4;  // its place is stated here

}  // namespace

int exif_orientation(std::span<const std::uint8_t> app1) {
  const auto block = exif_block(app1);
  if (!block) return 1;
  const auto value = block->value_of(block->number(kFirstDirectory, 4), 0x0112);
  return value ? static_cast<int>(block->number(*value, 2)) : 1;
}

std::string exif_start_utc(std::span<const std::uint8_t> app1) {
  const auto block = exif_block(app1);
  if (!block) return {};
  const auto photo = block->value_of(block->number(kFirstDirectory, 4), 0x8769);
  if (!photo) return {};
  const std::size_t directory = block->number(*photo, 4);
  std::string time = block->text_of(directory, 0x9003);  // "2026:05:04 11:12:33"
  constexpr std::size_t kMonth = 4, kDay = 7;
  if (time.size() <= kDay) return {};
  time[kMonth] = time[kDay] = '-';
  const std::string fraction = block->text_of(directory, 0x9291);
  return utc_text(time + (fraction.empty() ? "" : "." + fraction) + block->text_of(directory, 0x9011));
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
