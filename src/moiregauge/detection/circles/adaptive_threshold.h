// SPDX-License-Identifier: Apache-2.0
// Adaptive threshold of an image, split into rectangles that contain contrast. Most of an image is flat paper without
// outlines, and is skipped.
#pragma once

#include <cstdint>
#include <vector>

#include "moiregauge/detection/circles/threshold_rows.h"
#include "moiregauge/image/image.h"

namespace moiregauge::internal::markers_detail {

// Returns the image at half size: means of 2 x 2 pixels, halves rounded up. Drops an odd last row or column.
[[nodiscard]] Image<std::uint8_t> halved(const GreyView& picture);

struct PicturePart {
  int x = 0, y = 0;           // px, upper left corner
  int width = 0, height = 0;  // px
};

// Threshold of each tile: the mid-level between the extremes of its 3 x 3 tiles (as AprilTag 2, Wang and Olson 2016).
// A tile with threshold 0 has no dark pixel.
struct TileThresholds {
  std::ptrdiff_t stride = 0;        // tiles from row to row: whole strips plus one
  std::vector<std::uint8_t> tiles;  // grey levels, row by row
  std::vector<PicturePart> parts;   // rectangles that hold all tiles above 0, at least one block of 4 x 4 tiles apart

  [[nodiscard]] const std::uint8_t* from(Tile tile) const { return tiles.data() + tile.y * stride + tile.x; }
};

// Computes the thresholds in one pass over the image. `min_contrast` is in grey levels: a neighbourhood with a smaller
// range counts as flat. If `half` is not null, the same pass writes the image at half size to it.
[[nodiscard]] TileThresholds tile_thresholds(const GreyView& picture, int min_contrast, Image<std::uint8_t>* half);

// Returns a binary image of `part`: 1 where the smoothed image is below its threshold, 0 elsewhere. A dark disc has an
// outer outline, a light one is a hole. The view is valid until the next use of `memory`.
[[nodiscard]] GreyView dark_part(const GreyView& picture, const TileThresholds& thresholds, const PicturePart& part,
                                 std::vector<std::uint8_t>& memory);

}  // namespace moiregauge::internal::markers_detail
