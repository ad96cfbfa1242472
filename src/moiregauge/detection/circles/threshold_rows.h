// SPDX-License-Identifier: Apache-2.0
// What the search for outlines does with every pixel, rows at a time. Whole numbers only: the same on every SIMD
// target.
//
// Smoothed: by (1 2 1) x (1 2 1) / 16, rounded, the picture mirrored about its outermost pixels. Tiles are 4 x 4
// pixels; the last of a row or column may be narrower.
#pragma once

#include <cstdint>

#include "moiregauge/image/image.h"

namespace moiregauge::internal::markers_detail {

using GreyView = ImageView<std::uint8_t>;

inline constexpr int kTilePx = 4;
inline constexpr int kStripTiles = 64;  // rows of tiles are written in whole strips: memory must be there
inline constexpr int kStripPx = kTilePx * kStripTiles;

[[nodiscard]] constexpr int tiles_in(int pixels) { return (pixels + kTilePx - 1) / kTilePx; }
[[nodiscard]] constexpr int strips_in(int pixels) { return (pixels + kStripPx - 1) / kStripPx; }

// Smallest and largest grey level of each tile of the smoothed picture; 255 and 0 of those beyond its last column.
void tile_row_extremes(const GreyView& picture, int tile_y, std::uint8_t* low, std::uint8_t* high);

// Rows of tile extremes, with a readable tile before the first and after the last strip.
struct ThreeTileRows {
  const std::uint8_t* low[3];  // above, here, below
  const std::uint8_t* high[3];
};

// Half-way between the extremes of each tile's 3 x 3 neighbourhood; 0 where they differ by less than `min_contrast` and
// where the tile has no pixel below.
void tile_row_threshold(const ThreeTileRows& rows, int strips, int min_contrast, std::uint8_t* threshold);

// 1 where the smoothed picture is below its tile's threshold, otherwise 0: a strip of tiles from this one on. Rows of
// `dark` are `stride` apart; those that are in the picture are written in whole strips.
struct Tile {
  int x = 0, y = 0;
};
void dark_strip(const GreyView& picture, Tile first, const std::uint8_t* threshold, std::uint8_t* dark,
                std::ptrdiff_t stride);

// Means of 2 x 2 pixels, halves rounded up.
void halve_row(const std::uint8_t* upper, const std::uint8_t* lower, int halves, std::uint8_t* out);

// Smallest and largest sum of the 4 x 4 pixels of whole tiles.
struct TileSums {
  int smallest = 16 * 255;
  int largest = 0;
};
void tile_row_sums(const GreyView& picture, int tile_y, TileSums& sums);

}  // namespace moiregauge::internal::markers_detail
