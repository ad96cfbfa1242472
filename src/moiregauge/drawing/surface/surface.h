// SPDX-License-Identifier: Apache-2.0
// Owns cairo's objects, and converts an image to one.
#pragma once

#include <cstdint>
#include <memory>

#include <cairo.h>

#include "moiregauge/image/image.h"

namespace moiregauge::internal {

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;
using Context = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;

// Returns the grey image as a surface of the same size. Without memory it has no pixels (see cairo_surface_status).
[[nodiscard]] Surface grey_surface(ImageView<std::uint8_t> picture);

enum class Weight { kNormal, kBold };
// Selects the font of all drawings. `size`: in the context's unit.
// Throws: std::bad_alloc without memory for the fonts. Fontconfig does not survive that.
void choose_font(cairo_t* cr, double size, Weight weight);

// Appends bytes to the std::string `text`: cairo's write function for a file in memory.
[[nodiscard]] cairo_status_t append_bytes(void* text, const unsigned char* data, unsigned int length);

}  // namespace moiregauge::internal
