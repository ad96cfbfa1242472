// SPDX-License-Identifier: Apache-2.0
// Cairo's objects as owned values, and a picture as one of them.
#pragma once

#include <cstdint>
#include <memory>

#include <cairo.h>

#include "moiregauge/image/image.h"

namespace moiregauge::internal {

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;
using Context = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;

// The picture in grey, one pixel for each of its own; without pixels when there is no memory (cairo_surface_status).
[[nodiscard]] Surface grey_surface(ImageView<std::uint8_t> picture);

// Cairo's write function for a file in memory: `text` is the std::string behind which it puts the bytes.
[[nodiscard]] cairo_status_t append_bytes(void* text, const unsigned char* data, unsigned int length);

}  // namespace moiregauge::internal
