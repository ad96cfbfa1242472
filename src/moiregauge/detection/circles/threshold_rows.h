// SPDX-License-Identifier: Apache-2.0
// Per-pixel work of the search for outlines, by rows. Integer arithmetic only, so the bits are the same on every SIMD
// target.
//
// "Smoothed" means filtered by (1 2 1) x (1 2 1) / 16, rounded, with the image mirrored about its outermost pixels.
// Tiles are 4 x 4 pixels. The last tile of a row or column may be narrower.
#pragma once

#include <cstdint>

#include "moiregauge/image/image.h"

namespace moiregauge::internal::markers_detail {

using GreyView = ImageView<std::uint8_t>;

inline constexpr int kTilePx = 4;
inline constexpr int kStripTiles = 64;  // output rows are written in whole strips, and must have room for them
inline constexpr int kStripPx = kTilePx * kStripTiles;

[[nodiscard]] constexpr int tiles_in(int pixels) { return (pixels + kTilePx - 1) / kTilePx; }
[[nodiscard]] constexpr int strips_in(int pixels) { return (pixels + kStripPx - 1) / kStripPx; }

// Writes the smallest and largest grey level of each tile of the smoothed image. Tiles beyond the last column become
// 255 and 0.
void tile_row_extremes(const GreyView& picture, int tile_y, std::uint8_t* low, std::uint8_t* high);

// Extremes of three tile rows. Each row has a readable tile before the first and after the last strip.
struct ThreeTileRows {
  const std::uint8_t* low[3];   // grey levels: above, current, below
  const std::uint8_t* high[3];  // grey levels: above, current, below
};

// Writes the mid-level between the extremes of each tile's 3 x 3 neighbourhood. Writes 0 if they differ by less than
// `min_contrast` (grey levels), or if no pixel of the tile is below the mid-level.
void tile_row_threshold(const ThreeTileRows& rows, int strips, int min_contrast, std::uint8_t* threshold);

struct Tile {
  int x = 0, y = 0;  // column and row of tiles
};

// Thresholds one strip of tiles that begins at `first`: writes 1 where the smoothed image is below its tile's
// threshold, otherwise 0. Rows of `dark` are `stride` bytes apart. Only rows inside the image are written, each as a
// whole strip.
void dark_strip(const GreyView& picture, Tile first, const std::uint8_t* threshold, std::uint8_t* dark,
                std::ptrdiff_t stride);

// Writes the means of 2 x 2 pixels, halves rounded up.
void halve_row(const std::uint8_t* upper, const std::uint8_t* lower, int halves, std::uint8_t* out);

// Smallest and largest sum of the 16 pixels of whole tiles.
struct TileSums {
  int smallest = 16 * 255;
  int largest = 0;
};
// Extends `sums` by the tiles of one row.
void tile_row_sums(const GreyView& picture, int tile_y, TileSums& sums);

}  // namespace moiregauge::internal::markers_detail
