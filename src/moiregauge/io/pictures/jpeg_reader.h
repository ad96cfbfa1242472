// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "moiregauge/io/pictures/picture.h"

namespace moiregauge::internal {

// Reads the luma plane of a JPEG as stored, and rotates it upright by its Exif orientation.
// Fails: kUnreadable (missing), kUnsupported (CMYK, mirrored, too many pixels), kDamaged (truncated, corrupt).
[[nodiscard]] PictureOrError read_jpeg(const std::string& path, std::int64_t max_pixels = InputOptions{}.max_pixels);

}  // namespace moiregauge::internal
