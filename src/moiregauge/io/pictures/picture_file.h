// SPDX-License-Identifier: Apache-2.0
// A picture file of any kind we read, told apart by its first bytes, not by its name.
#pragma once

#include <string>

#include "moiregauge/io/pictures/picture.h"

namespace moiregauge::internal {

enum class PictureKind { kNone, kPng, kJpeg, kTiff };

[[nodiscard]] PictureKind picture_kind(const std::string& path);

// The file's picture; of a TIFF stack its first page.
[[nodiscard]] PictureOrError read_picture(const std::string& path, std::int64_t max_pixels = InputOptions{}.max_pixels);

}  // namespace moiregauge::internal
