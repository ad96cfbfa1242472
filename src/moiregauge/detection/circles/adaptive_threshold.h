// SPDX-License-Identifier: Apache-2.0
// Where a picture is darker than its neighbourhood, part by part: most of a picture is paper, and there is nothing to
// follow the outline of.
#pragma once

#include <cstdint>
#include <vector>

#include "moiregauge/detection/circles/threshold_rows.h"
#include "moiregauge/image/image.h"

namespace moiregauge::internal::markers_detail {

// Means of 2 x 2 pixels; an odd last row or column is left out.
[[nodiscard]] Image<std::uint8_t> halved(const GreyView& picture);

struct PicturePart {
  int x = 0, y = 0;           // px, its upper left
  int width = 0, height = 0;  // px
};

// Each tile's threshold: half-way between the extremes of 3 x 3 tiles (as AprilTag 2, Wang 2016). Nothing of a tile
// whose threshold is 0 is below it.
struct TileThresholds {
  std::ptrdiff_t stride = 0;        // rows in whole strips, and one more
  std::vector<std::uint8_t> tiles;  // row by row
  std::vector<PicturePart> parts;   // all tiles above 0, in rectangles at least a tile apart

  [[nodiscard]] const std::uint8_t* from(Tile tile) const { return tiles.data() + tile.y * stride + tile.x; }
};

// `half`, if any, becomes the halved picture: its rows are at hand.
[[nodiscard]] TileThresholds tile_thresholds(const GreyView& picture, int min_contrast, Image<std::uint8_t>* half);

// 1 where the smoothed picture is below the threshold, 0 elsewhere. Dark discs have outer outlines here, light ones are
// holes. Valid until `memory` is used again.
[[nodiscard]] GreyView dark_part(const GreyView& picture, const TileThresholds& thresholds, const PicturePart& part,
                                 std::vector<std::uint8_t>& memory);

}  // namespace moiregauge::internal::markers_detail
