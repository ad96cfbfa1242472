// SPDX-License-Identifier: Apache-2.0
// Passes by tiles of 16 x 8 pixels, which sum all columns. A tile is inside the window, across its edge, or outside.
// patch_pass.cc includes this file once for every SIMD target.
#if defined(MOIREGAUGE_PATCH_TILES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MOIREGAUGE_PATCH_TILES_INL_H
#undef MOIREGAUGE_PATCH_TILES_INL_H
#else
#define MOIREGAUGE_PATCH_TILES_INL_H
#endif

#include <algorithm>
#include <array>
#include <cmath>

#include <hwy/highway.h>

#include "moiregauge/image/fetch_row.h"
#include "moiregauge/phase/fit/patch_columns-inl.h"
#include "moiregauge/phase/fit/patch_job.h"
#include "moiregauge/phase/fit/patch_products-inl.h"
#include "moiregauge/phase/fit/patch_strips-inl.h"

HWY_BEFORE_NAMESPACE();
namespace moiregauge::internal {
// Vectors are parameters of their own, because some targets do not allow them in structs.
// NOLINTBEGIN(readability-function-size)
namespace HWY_NAMESPACE {

static_assert(SomePositions::kMost >= kTileRows);

// Position of a tile relative to the window.
enum class TilePlace { kInside, kAcross, kOutside };

// A quantity that is linear in the pixel's position: value at the middle pixel, and changes per pixel.
struct Line {
  double at_0, per_x, per_y;
  // Largest difference of a tile's pixels from its middle.
  double spread = 0.5 * (kBlockWidth - 1) * std::abs(per_x) + 0.5 * (kTileRows - 1) * std::abs(per_y);

  // Returns the value in the middle of the tile from (x, y) on, px from the middle pixel.
  [[nodiscard]] HWY_INLINE double middle(int x, int y) const {
    return at_0 + per_x * (x + 0.5 * (kBlockWidth - 1)) + per_y * (y + 0.5 * (kTileRows - 1));
  }
};

// Edges of the window: |U| = Z and |V| = Z. Each is a line, so that a tile's corners have its extreme values.
struct Edges {
  Line z;
  std::array<Line, 4> within, beyond;  // below zero inside; above zero outside

  explicit Edges(const PatchJob& job) : z(line(job, 6, 1.0, 0.0)) {
    constexpr double kMargin = 1e-4;  // relative to the window; exceeds the error of single precision
    std::size_t to = 0;
    for (const std::size_t axis : {0, 3}) {
      for (const double side : {1.0, -1.0}) {
        within[to] = line(job, axis, side, 1.0 - kMargin);
        beyond[to++] = line(job, axis, side, 1.0 + kMargin);
      }
    }
  }

  // Returns the place of the tile from (x, y) on, px from the middle pixel.
  [[nodiscard]] TilePlace place_of(int x, int y) const {
    if (!(z.middle(x, y) > z.spread)) return TilePlace::kAcross;
    bool is_inside = true, is_outside = false;
    for (std::size_t k = 0; k < within.size(); ++k) {
      is_inside &= within[k].middle(x, y) + within[k].spread < 0.0;
      is_outside |= beyond[k].middle(x, y) - beyond[k].spread > 0.0;
    }
    return is_inside ? TilePlace::kInside : is_outside ? TilePlace::kOutside : TilePlace::kAcross;
  }

 private:
  // Returns side * (row of the map from element k on) - limit * Z.
  static Line line(const PatchJob& job, std::size_t k, double side, double limit) {
    const auto element = [&job](std::size_t i) { return double{job.uv_from_px[i]}; };
    const auto part = [&](std::size_t i) { return side * element(k + i) - limit * element(6 + i); };
    return {part(2), part(0), part(1)};
  }
};

// A window's pixels as tiles.
template <typename Grey>
struct Tiling {
  const PatchJob& job;
  const Patch& patch;
  const ImageView<Grey>& picture;
  const Edges edges = Edges(job);
};

// Adds a row of a tile and returns the number of pixels inside the window. `in_box`: lanes inside the box.
template <Sum kSum, bool kAllInside, typename Grey, typename Mask>
HWY_INLINE int add_tile_row(const Tiling<Grey>& t, const Grey* pixels, const SomePositions& at, Mask in_box, int row,
                            TileRows& rows, PendingColumns& columns) {
  const Float d;
  const V u = hn::Load(d, at.u[row]), v = hn::Load(d, at.v[row]);
  const auto in = hn::And(in_box, lanes_inside(t.patch, u, v));
  if (!kAllInside && hn::AllFalse(d, in)) {
    rows.put_none(row);
    return 0;
  }
  const Level l = at.level(t.patch, row);
  const V gain = t.patch.gain(u, v);
  V left = hn::Sub(greys(pixels), t.patch.shown(u, v, l, gain)), inside = t.patch.one;
  int count = kLanes;
  if constexpr (!kAllInside) {
    left = hn::IfThenElseZero(in, left), inside = hn::IfThenElseZero(in, inside);
    count = static_cast<int>(hn::CountTrue(d, in));
  }
  rows.put(row, left, gain, hn::Load(d, at.per_z[row]), l);
  if constexpr (kSum == Sum::kNormal) columns.put(inside, scaled(t.patch, l, gain), u, v);
  return count;
}

// Pixels of the rows of a tile. They are located before the loop over rows, so that its vectors stay in registers.
template <typename Grey>
struct PixelRows {
  const Grey* from[kTileRows];
  Grey beyond[kTileRows][kBlockWidth];

  HWY_INLINE PixelRows(const ImageView<Grey>& picture, int x, int y, int count) {
    for (int row = 0; row < count; ++row) from[row] = pixels_from(picture, x, y + row, beyond[row]);
  }
};

// Adds a tile to the sums of its strip and returns the number of pixels inside the window.
template <Sum kSum, bool kAllInside, typename Grey>
HWY_INLINE int add_rows(const Tiling<Grey>& t, int x, int y, const RowSpan<kAllInside>& span, int lane, StripSums& sums,
                        LaneSums& lanes) {
  const V dx = lanes_from(x - t.job.x + lane);
  SomePositions at;
  for (int row = 0; row < span.count(); ++row)
    at.put(t.patch, row, Row(t.job, static_cast<float>(y + row - t.job.y)), dx);
  const auto in_box = hn::Le(dx, hn::Set(Float(), static_cast<float>(t.job.box.x1 - t.job.x)));
  const PixelRows<Grey> greys_of(t.picture, x, y, span.count());
  TileRows rows;
  PendingColumns columns;
  int pixels = 0;
  for (int row = 0; row < span.count(); ++row)
    pixels += add_tile_row<kSum, kAllInside>(t, greys_of.from[row] + lane, at, in_box, row, rows, columns);
  add_tile_sums(rows, span, lane, sums);
  if constexpr (kSum == Sum::kNormal) add_pending(columns, lane, lanes);
  return pixels;
}

template <Sum kSum, typename Grey>
int add_tile(const Tiling<Grey>& t, int x, int y, int count, float eta, int lane, StripSums& sums, LaneSums& lanes) {
  const bool is_cut = count < kTileRows || x + kBlockWidth - 1 > t.job.box.x1;
  const TilePlace place = t.edges.place_of(x - t.job.x, y - t.job.y);
  if (place == TilePlace::kOutside) return 0;
  if (place == TilePlace::kInside && !is_cut)
    return add_rows<kSum, true>(t, x, y, RowSpan<true>(count, eta), lane, sums, lanes);
  return add_rows<kSum, false>(t, x, y, RowSpan<false>(count, eta), lane, sums, lanes);
}

// Adds up to eight blocks of a strip from x on, over the rows first to last. Returns the number of pixels.
template <Sum kSum, typename Grey>
int add_chunk(const Tiling<Grey>& t, int x, int first, int last, int lane, LaneSums& lanes) {
  StripSums sums[kTilesPerChunk] = {};
  const int blocks = std::min(kTilesPerChunk, (t.job.box.x1 - x) / kBlockWidth + 1);
  const float middle = static_cast<float>(first) + 0.5F * (kStripRows - 1);
  int pixels = 0;
  for (int y = first; y <= last; y += kTileRows) {
    const int count = std::min(kTileRows, last - y + 1);
    const float eta = (static_cast<float>(y) - middle) / kEtaRows;
    for (int row = y + kTileRows; lane == 0 && row < std::min(y + 2 * kTileRows, t.job.box.y1 + 1); ++row)
      fetch_row(t.picture, row, x, std::min(x + blocks * kBlockWidth - 1, t.job.box.x1));
    for (int b = 0; b < blocks; ++b)
      pixels += add_tile<kSum>(t, x + b * kBlockWidth, y, count, eta, lane, sums[b], lanes);
  }
  for (int b = 0; b < blocks; ++b) {
    const V dx = lanes_from(x + b * kBlockWidth - t.job.x + lane);
    expand_strip(sums[b], t.job, middle - static_cast<float>(t.job.y), dx, lane, lanes);
  }
  return pixels;
}

template <Sum kSum, typename Grey>
int add_strip(const Tiling<Grey>& t, int first, int last, LaneSums& lanes) {
  std::fill_n(&lanes.right[0][0], (kColumns + 1) * kBlockWidth, 0.0F);
  int pixels = 0;
  for (int lane = 0; lane < kBlockWidth; lane += kLanes) {
    for (int x = t.job.box.x0; x <= t.job.box.x1; x += kTilesPerChunk * kBlockWidth)
      pixels += add_chunk<kSum>(t, x, first, last, lane, lanes);
  }
  return pixels;
}

// Sums by tiles. Their derivatives are per distance of nodes, the totals per pitch.
template <Sum kSum, typename Grey>
void pass_by_tiles(const PatchJob& job, const ImageView<Grey>& picture, PatchTotals& out) {
  LaneSums lanes;
  const Patch patch(job);
  const Tiling<Grey> tiling{job, patch, picture};
  for (int y = job.box.y0; y <= job.box.y1; y += kStripRows) {
    if constexpr (kSum == Sum::kNormal) std::fill_n(&lanes.normal[0][0], kProducts * kBlockWidth, 0.0F);
    out.pixels += add_strip<kSum>(tiling, y, std::min(y + kStripRows - 1, job.box.y1), lanes);
    for (int k = 0; k <= kColumns; ++k) out.sums[static_cast<std::size_t>(k)] += folded(lanes.right[k]);
    if constexpr (kSum == Sum::kNormal) {
      for (int i = 0, k = 0; i < kColumns; ++i) {
        for (int j = 0; j <= i; ++j, ++k) (*out.normal)(i, j) += folded(lanes.normal[k]);
      }
    }
  }
  const double side = job.table->side;
  for (int k = kLightColumns; k < kColumns; ++k)
    out.sums[static_cast<std::size_t>(k)] *= k < kBaseColumns ? side * side : side;
}

}  // namespace HWY_NAMESPACE
// NOLINTEND(readability-function-size)
}  // namespace moiregauge::internal
HWY_AFTER_NAMESPACE();

#endif
