// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace moiregauge::internal {

// Returns the orientation tag (0x0112) of an Exif block, given the APP1 marker of a JPEG. Returns 1 (upright) without a
// tag.
[[nodiscard]] int exif_orientation(std::span<const std::uint8_t> app1);

// Returns the time of an image in UTC (DateTimeOriginal with its OffsetTimeOriginal), given the APP1 marker of a JPEG.
// Empty: it is not stated, or without an offset, so that its zone is unknown.
[[nodiscard]] std::string exif_start_utc(std::span<const std::uint8_t> app1);

// Returns the clockwise rotation in degrees (0, 90, 180, 270) that shows an image of this orientation (1 to 8) upright.
// Returns nothing for mirrored images.
[[nodiscard]] std::optional<int> rotation_of_orientation(int orientation);

}  // namespace moiregauge::internal
