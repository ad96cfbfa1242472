// SPDX-License-Identifier: Apache-2.0
// Pages as PNG files, written fast: a page is as large as the camera's picture, and nearly all of it is the picture.
#pragma once

#include <cstdint>
#include <vector>

#include <cairo.h>

namespace moiregauge::internal {

// The file's bytes, every pixel of an RGB24 surface as it is; empty when there is no memory for it.
[[nodiscard]] std::vector<std::uint8_t> png_of(cairo_surface_t* surface);

}  // namespace moiregauge::internal
