// SPDX-License-Identifier: Apache-2.0
// Shrinks an image for the report page, so that the page is small enough for mail.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace moiregauge::internal {

// Returns a PNG as a JPEG of at most 1600 px width. Returns the PNG itself if it is smaller or cannot be read.
[[nodiscard]] std::vector<std::uint8_t> page_picture(std::span<const std::uint8_t> png);

}  // namespace moiregauge::internal
