// SPDX-License-Identifier: Apache-2.0
// Cuts out a marker as a fixed camera would see it, along the board's axes at a fixed scale (seed paper Figs. 9 and
// 11). References do not move in their crops, and targets move only by their own displacement.
#pragma once

#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

// Pixel (column, row) of a crop shows the board at (first.x + column * mm_per_px, first.y - row * mm_per_px).
struct CropPlan {
  BoardPoint first;        // mm, at the centre of the crop's first pixel
  double mm_per_px = 0.0;  // finest scale of the marker in the reference frame
  int width = 0;           // px
  int height = 0;
};

// Plans the crop of a marker's circle and grating. The margin is a tenth of the marker for a reference. It is half of
// the marker for a target, so that its movement remains visible.
[[nodiscard]] CropPlan plan_crop(const Reference& reference, std::size_t marker);

struct Crop {
  Image<std::uint8_t> grey;  // scaled to 8 bits; black outside the image
  double inside = 0.0;       // share of the crop that is inside the image
};

// Cuts out a crop, by the spline through the pixels. `view` is that of this frame and contains the camera's motion.
[[nodiscard]] Crop cut_out(const GreyPicture& picture, const View& view, const CropPlan& plan);

}  // namespace moiregauge::internal
