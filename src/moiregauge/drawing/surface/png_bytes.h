// SPDX-License-Identifier: Apache-2.0
// Writes pages as PNG files quickly, because a page is as large as the camera's image.
#pragma once

#include <cstdint>
#include <vector>

#include <cairo.h>

namespace moiregauge::internal {

// Returns the file's bytes with every pixel of an RGB24 surface. Empty if out of memory.
[[nodiscard]] std::vector<std::uint8_t> png_of(cairo_surface_t* surface);

}  // namespace moiregauge::internal
