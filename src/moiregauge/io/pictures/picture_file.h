// SPDX-License-Identifier: Apache-2.0
// Reads an image file of any supported format. The first bytes decide the format, not the name.
#pragma once

#include <string>

#include "moiregauge/io/pictures/picture.h"

namespace moiregauge::internal {

enum class PictureKind { kNone, kPng, kJpeg, kTiff };

[[nodiscard]] PictureKind picture_kind(const std::string& path);

// Returns the image of a file, or the first page of a TIFF stack.
[[nodiscard]] PictureOrError read_picture(const std::string& path, std::int64_t max_pixels = InputOptions{}.max_pixels);

}  // namespace moiregauge::internal
