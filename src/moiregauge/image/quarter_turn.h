// SPDX-License-Identifier: Apache-2.0
// Pictures turned by whole quarters, pixel for pixel: how a rotation tag is applied without touching a grey level.
#pragma once

#include <cstddef>

#include "moiregauge/image/image.h"

namespace moiregauge::internal {

// Writes the picture turned clockwise by 0, 90, 180 or 270 degrees, rows packed, to `out` (width * height words).
template <typename Grey>
void turn_clockwise(ImageView<Grey> stored, int degrees, Grey* out) {
  const bool lies = degrees == 90 || degrees == 270;
  const int width = lies ? stored.height : stored.width;
  const int height = lies ? stored.width : stored.height;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x, ++out) {
      // Where the shown pixel lay: after a quarter clockwise the stored left column is the top row, bottom end first.
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
