// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "moiregauge/image/image.h"

namespace moiregauge::internal {

// Returns the image averaged over blocks of n x n pixels, n the smallest number that gives at most `max_width` pixels.
[[nodiscard]] Image<std::uint8_t> shrunk_to_width(const ImageView<std::uint8_t>& image, int max_width);

// Returns the image as a grey JPEG. Returns an empty text if libjpeg fails.
[[nodiscard]] std::string luma_jpeg(const ImageView<std::uint8_t>& image);

}  // namespace moiregauge::internal
