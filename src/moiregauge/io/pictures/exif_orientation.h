// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace moiregauge::internal {

// The orientation tag (0x0112) of an Exif block as it stands in a JPEG's APP1 marker; 1 (upright) when there is none.
[[nodiscard]] int exif_orientation(std::span<const std::uint8_t> app1);

// Clockwise quarters, in degrees, that show a picture of this orientation (1 to 8) upright; nothing for mirrored ones.
[[nodiscard]] std::optional<int> rotation_of_orientation(int orientation);

}  // namespace moiregauge::internal
