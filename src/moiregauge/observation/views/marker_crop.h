// SPDX-License-Identifier: Apache-2.0
// A marker as a camera that never moved would see it: cut out along the board's axes at a fixed scale (seed paper Figs.
// 9 and 11). References stand still in their crops; targets move in theirs, and by nothing but their own displacement.
#pragma once

#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

// Pixel (column, row) of a crop shows the board at (first.x + column * mm_per_px, first.y - row * mm_per_px).
struct CropPlan {
  BoardPoint first;        // mm, under the centre of the crop's first pixel
  double mm_per_px = 0.0;  // as fine as the reference frame sees the marker
  int width = 0;           // px
  int height = 0;
};

// The marker's circle and grating with some board round it: a tenth of the marker round a reference, half of it round a
// target, so that its travel stays in sight.
[[nodiscard]] CropPlan plan_crop(const Reference& reference, std::size_t marker);

struct Crop {
  Image<std::uint8_t> grey;  // the upper 8 bits; black where the picture ends
  double inside = 0.0;       // share of the crop that the picture holds
};

// By the spline through the pixels. `view`: how this frame sees the board, the camera's motion in it.
[[nodiscard]] Crop cut_out(const GreyPicture& picture, const View& view, const CropPlan& plan);

}  // namespace moiregauge::internal
