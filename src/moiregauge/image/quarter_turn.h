// SPDX-License-Identifier: Apache-2.0
// Rotation of images by quarter turns, pixel for pixel. A rotation tag is applied without changing a grey level.
#pragma once

#include <cstddef>

#include "moiregauge/image/image.h"

namespace moiregauge::internal {

// Writes the image, rotated clockwise by 0, 90, 180 or 270 degrees, with packed rows to `out` (width * height words).
template <typename Grey>
void turn_clockwise(ImageView<Grey> stored, int degrees, Grey* out) {
  const bool lies = degrees == 90 || degrees == 270;
  const int width = lies ? stored.height : stored.width;
  const int height = lies ? stored.width : stored.height;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x, ++out) {
      // After a clockwise quarter turn the stored left column is the top row, with its bottom end first.
      if (degrees == 90)
        *out = stored.at(y, width - 1 - x);
      else if (degrees == 180)
        *out = stored.at(width - 1 - x, height - 1 - y);
      else if (degrees == 270)
        *out = stored.at(height - 1 - y, x);
      else
        *out = stored.at(x, y);
    }
  }
}

template <typename Grey>
[[nodiscard]] Image<Grey> turned_clockwise(ImageView<Grey> stored, int degrees) {
  const bool lies = degrees == 90 || degrees == 270;
  Image<Grey> shown(lies ? stored.height : stored.width, lies ? stored.width : stored.height);
  turn_clockwise(stored, degrees, shown.row(0).data());
  return shown;
}

}  // namespace moiregauge::internal
