// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/phase/fit/patch_pass.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

#include "moiregauge/image/fetch_row.h"
#include "moiregauge/image/simd_options.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "moiregauge/phase/fit/patch_pass.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "moiregauge/phase/fit/patch_columns-inl.h"
#include "moiregauge/phase/fit/patch_job.h"
#include "moiregauge/phase/fit/patch_tiles-inl.h"

HWY_BEFORE_NAMESPACE();
namespace moiregauge::internal {
// Vectors are parameters of their own, because some targets do not allow them in structs.
// NOLINTBEGIN(readability-function-size)
namespace HWY_NAMESPACE {

template <Sum kSum>
using Registers = V[sums_of(kSum)];

// Columns of a shift for several vectors of a row. Their sums are added afterwards in a loop of its own: it needs nearly
// all registers of some targets, and so does the prediction.
struct ShiftVectors {
  static constexpr int kMost = 8;
  int count = 0;
  alignas(64) float left[kMost][kBlockWidth], c[kShiftColumns][kMost][kBlockWidth];

  // `residual`: zero outside the window.
  HWY_INLINE void put(V residual, V inside, const Level& l) {
    const Float d;
    hn::Store(residual, d, left[count]), hn::Store(inside, d, c[0][count]);
    hn::Store(hn::Mul(l.t, inside), d, c[1][count]), hn::Store(hn::Mul(l.tx, inside), d, c[2][count]);
    hn::Store(hn::Mul(l.ty, inside), d, c[3][count]);
    ++count;
  }
};

HWY_INLINE void add_shifts(const ShiftVectors& vectors, Registers<Sum::kShift>& sums) {
  const Float d;
  for (int n = 0; n < vectors.count; ++n) {
    const V left = hn::Load(d, vectors.left[n]);
    V c[kShiftColumns];
#pragma GCC unroll 4
    for (int i = 0; i < kShiftColumns; ++i) c[i] = hn::Load(d, vectors.c[i][n]);
    int to = 0;
#pragma GCC unroll 4
    for (int i = 0; i < kShiftColumns; ++i, ++to) sums[to] = hn::Add(sums[to], hn::Mul(left, c[i]));
    sums[to] = hn::Add(sums[to], hn::Mul(left, left)), ++to;
#pragma GCC unroll 4
    for (int i = 0; i < kShiftColumns; ++i) {
#pragma GCC unroll 4
      for (int j = 0; j <= i; ++j, ++to) sums[to] = hn::Add(sums[to], hn::Mul(c[i], c[j]));
    }
  }
}

// Columns of blocks whose products are pending. A tile of products then stays in registers for all of them.
struct PendingColumns {
  static constexpr int kMost = 8;
  int blocks = 0;
  alignas(64) float c[kColumns][kMost][kBlockWidth];

  HWY_INLINE void put(V inside, const Level& l, V u, V v) {
    expand(inside, times(l, inside), u, v, [this](int k, V value) { hn::Store(value, Float(), c[k][blocks]); });
    ++blocks;
  }
};

constexpr int kTile = 3;
static_assert(kColumns % kTile == 0);

// Adds the products of three columns from `i` on with three from `j` on. On the diagonal (i = j) only the lower ones.
template <bool kDiagonal>
HWY_INLINE void add_tile(const PendingColumns& pending, int i, int j, int lane, LaneSums& lanes) {
  const Float d;
  V sums[kTile][kTile];
  const auto memory = [&](int a, int b) { return lanes.normal[(i + a) * (i + a + 1) / 2 + j + b] + lane; };
#pragma GCC unroll 3
  for (int a = 0; a < kTile; ++a) {
#pragma GCC unroll 3
    for (int b = 0; b <= (kDiagonal ? a : kTile - 1); ++b) sums[a][b] = hn::Load(d, memory(a, b));
  }
  for (int n = 0; n < pending.blocks; ++n) {
    V across[kTile];
#pragma GCC unroll 3
    for (int b = 0; b < kTile; ++b) across[b] = hn::Load(d, pending.c[j + b][n]);
#pragma GCC unroll 3
    for (int a = 0; a < kTile; ++a) {
      const V down = kDiagonal ? across[a] : hn::Load(d, pending.c[i + a][n]);
#pragma GCC unroll 3
      for (int b = 0; b <= (kDiagonal ? a : kTile - 1); ++b) sums[a][b] = hn::Add(sums[a][b], hn::Mul(down, across[b]));
    }
  }
#pragma GCC unroll 3
  for (int a = 0; a < kTile; ++a) {
#pragma GCC unroll 3
    for (int b = 0; b <= (kDiagonal ? a : kTile - 1); ++b) hn::Store(sums[a][b], d, memory(a, b));
  }
}

HWY_INLINE void add_pending(PendingColumns& pending, int lane, LaneSums& lanes) {
  for (int i = 0; i < kColumns; i += kTile) {
    for (int j = 0; j < i; j += kTile) add_tile<false>(pending, i, j, lane, lanes);
    add_tile<true>(pending, i, i, lane, lanes);
  }
  pending.blocks = 0;
}

// Adds to the sums of the window's blocks. Neighbouring pixels share one or two of these, which the loop visits.
template <typename Mask>
HWY_INLINE void add_blocks(V left, Mask in, V u, V v, int lane, LaneSums& sums) {
  const Float d;
  const V one = hn::Set(d, 1.0F), half = hn::Set(d, 0.5F * kWindowBlocks), last = hn::Set(d, kWindowBlocks - 1.0F);
  const auto along = [&](V uv) { return hn::Min(hn::Floor(hn::Mul(hn::Add(uv, one), half)), last); };
  const V block = plus(along(u), along(v), hn::Set(d, float{kWindowBlocks}));
  const V squares = hn::Mul(left, left);
  const int low = static_cast<int>(hn::GetLane(hn::MinOfLanes(d, hn::IfThenElse(in, block, hn::Set(d, 1e3F)))));
  const int high = static_cast<int>(hn::GetLane(hn::MaxOfLanes(d, hn::IfThenElseZero(in, block))));
  for (int b = low; b <= high; ++b) {
    const auto here = hn::And(in, hn::Eq(block, hn::Set(d, static_cast<float>(b))));
    add_to(sums.squares[b] + lane, hn::IfThenElseZero(here, squares));
    sums.pixels[b] += static_cast<int>(hn::CountTrue(d, here));
  }
}

// Returns the lanes inside the window.
HWY_INLINE auto lanes_inside(const Patch& patch, V u, V v) {
  return hn::Le(hn::Max(hn::Abs(u), hn::Abs(v)), patch.one);
}

// Returns a level with derivatives per pitch, times the gain.
HWY_INLINE Level scaled(const Patch& patch, const Level& l, V gain) {
  const V slope = hn::Mul(gain, patch.side), bend = hn::Mul(slope, patch.side);
  return {
      l.t, hn::Mul(l.tx, slope), hn::Mul(l.ty, slope), hn::Mul(l.bx, bend), hn::Mul(l.by, bend), hn::Mul(l.edge, bend)};
}

// Positions of the pixels of several vectors. They are computed for all vectors first: a node's index is then in memory,
// not on its way to it, when it is read.
struct SomePositions {
  static constexpr int kMost = 8;
  alignas(64) LaneRow u[kMost], v[kMost], per_z[kMost], x[kMost], y[kMost];
  alignas(64) std::int32_t node[kMost][kBlockWidth];

  // `dx`: distances of the lanes from the middle pixel, px.
  HWY_INLINE void put(const Patch& patch, int n, const Row& row, V dx) {
    const Float d;
    const Positions at(patch, row, dx);
    const FromNode from =
        patch.table.find(plus(patch.x0, at.u, patch.half_x), plus(patch.y0, at.v, patch.half_y), node[n]);
    hn::Store(at.u, d, u[n]), hn::Store(at.v, d, v[n]), hn::Store(at.per_z, d, per_z[n]);
    hn::Store(from.x, d, x[n]), hn::Store(from.y, d, y[n]);
  }

  // Returns level and derivatives at vector n.
  HWY_INLINE Level level(const Patch& patch, int n) const {
    return patch.table.at(node[n], {hn::Load(Float(), x[n]), hn::Load(Float(), y[n])});
  }
};
static_assert(SomePositions::kMost >= kTileRows && SomePositions::kMost <= ShiftVectors::kMost);

// Adds vector n and returns the number of pixels inside the window. `there`: lanes inside the box.
template <Sum kSum, typename Grey, typename Mask>
HWY_INLINE int add_vector(const Patch& patch, const Grey* pixels, const SomePositions& at, int n, Mask there, int lane,
                          LaneSums& lanes, ShiftVectors& shifts, Registers<kSum>& sums) {
  const Float d;
  const V u = hn::Load(d, at.u[n]), v = hn::Load(d, at.v[n]);
  const auto in = hn::And(there, lanes_inside(patch, u, v));
  if (hn::AllFalse(d, in)) return 0;
  const Level l = at.level(patch, n);
  const V gain = patch.gain(u, v);
  const V left = hn::IfThenElseZero(in, hn::Sub(greys(pixels), patch.shown(u, v, l, gain)));
  if constexpr (kSum == Sum::kBlocks) {
    sums[0] = hn::Add(sums[0], hn::Mul(left, left));
    add_blocks(left, in, u, v, lane, lanes);
  } else {
    shifts.put(left, hn::IfThenElseZero(in, patch.one), scaled(patch, l, gain));
  }
  return static_cast<int>(hn::CountTrue(d, in));
}

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

// Returns the sum of sixteen lanes, added by halves.
HWY_INLINE double folded(float* lanes) {
  const hn::CappedTag<float, 4> d;
  for (int half = kBlockWidth / 2; half >= 4; half /= 2) {
    for (int i = 0; i < half; i += static_cast<int>(hn::MaxLanes(d)))
      hn::Store(hn::Add(hn::Load(d, lanes + i), hn::Load(d, lanes + i + half)), d, lanes + i);
  }
  return static_cast<double>((lanes[0] + lanes[2]) + (lanes[1] + lanes[3]));
}

// Rows by which memory is fetched ahead. Chosen.
constexpr int kRowsAhead = 4;

// Adds a row and returns the number of pixels inside the window.
template <Sum kSum, typename Grey>
HWY_INLINE int add_row(const PatchJob& job, const Patch& patch, const ImageView<Grey>& picture, int y, int lane,
                       LaneSums& lanes, Registers<kSum>& sums) {
  const Row row(job, static_cast<float>(y - job.y));
  const int step = job.steps.blocks * kBlockWidth;
  const int x0 = job.box.x0 + (y - job.box.y0) / job.steps.rows % job.steps.blocks * kBlockWidth;
  const V last = hn::Set(Float(), static_cast<float>(job.box.x1 - job.x));
  const auto dx = [&](int x) { return lanes_from(x - job.x + lane); };
  SomePositions at;
  Grey edge[kBlockWidth];  // used once: only the last vector reaches beyond the image
  int pixels = 0;
  for (int first = x0; first <= job.box.x1; first += SomePositions::kMost * step) {
    const int blocks = std::min(SomePositions::kMost, (job.box.x1 - first) / step + 1);
    const Grey* from[SomePositions::kMost];
    for (int n = 0; n < blocks; ++n) {
      from[n] = pixels_from(picture, first + n * step, y, edge) + lane;
      at.put(patch, n, row, dx(first + n * step));
    }
    ShiftVectors shifts;
    for (int n = 0; n < blocks; ++n) {
      const auto there = hn::Le(dx(first + n * step), last);
      pixels += add_vector<kSum>(patch, from[n], at, n, there, lane, lanes, shifts, sums);
    }
    if constexpr (kSum == Sum::kShift) add_shifts(shifts, sums);
  }
  return pixels;
}

template <Sum kSum, typename Grey>
int add_band(const PatchJob& job, const Patch& patch, const ImageView<Grey>& picture, int first, int last,
             LaneSums& lanes) {
  const Float d;
  int pixels = 0;
  for (int lane = 0; lane < kBlockWidth; lane += kLanes) {
    Registers<kSum> sums;
    for (int k = 0; k < sums_of(kSum); ++k) sums[k] = hn::Zero(d);
    for (int y = first; y <= last; y += job.steps.rows) {
      const int ahead = y + kRowsAhead * job.steps.rows;
      if (lane == 0 && ahead <= job.box.y1) fetch_row(picture, ahead, job.box.x0, job.box.x1);
      pixels += add_row<kSum>(job, patch, picture, y, lane, lanes, sums);
    }
    for (int k = 0; k < sums_of(kSum); ++k) hn::Store(sums[k], d, lanes.right[k] + lane);
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

template <Sum kSum, typename Grey>
void pass(const PatchJob& job, const ImageView<Grey>& picture, PatchTotals& out) {
  LaneSums lanes;
  const Patch patch(job);
  const int band = kBandRows * job.steps.rows;
  if constexpr (kSum == Sum::kBlocks) {
    std::fill_n(&lanes.squares[0][0], out.blocks->squares.size() * kBlockWidth, 0.0F);
    std::fill_n(lanes.pixels, out.blocks->pixels.size(), 0);
  }
  for (int y = job.box.y0; y <= job.box.y1; y += band) {
    out.pixels += add_band<kSum>(job, patch, picture, y, std::min(y + band - 1, job.box.y1), lanes);
    for (int k = 0; k < sums_of(kSum); ++k) out.sums[static_cast<std::size_t>(k)] += folded(lanes.right[k]);
  }
  if constexpr (kSum == Sum::kBlocks) {
    for (std::size_t b = 0; b < out.blocks->squares.size(); ++b) {
      out.blocks->squares[b] = folded(lanes.squares[b]);
      out.blocks->pixels[b] = lanes.pixels[b];
    }
  }
}

template <typename Grey>
void pass_of(const PatchJob& job, const ImageView<Grey>& picture, Sum sum, PatchTotals& out) {
  switch (sum) {
    case Sum::kRight:
      return pass_by_tiles<Sum::kRight>(job, picture, out);
    case Sum::kNormal:
      return pass_by_tiles<Sum::kNormal>(job, picture, out);
    case Sum::kShift:
      return pass<Sum::kShift>(job, picture, out);
    case Sum::kBlocks:
      return pass<Sum::kBlocks>(job, picture, out);
  }
}

void Pass8(const PatchJob& job, const ImageView<std::uint8_t>& p, Sum sum, PatchTotals& out) {
  pass_of(job, p, sum, out);
}
void Pass16(const PatchJob& job, const ImageView<std::uint16_t>& p, Sum sum, PatchTotals& out) {
  pass_of(job, p, sum, out);
}

}  // namespace HWY_NAMESPACE
// NOLINTEND(readability-function-size)
}  // namespace moiregauge::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace moiregauge::internal {
HWY_EXPORT(Pass8);
HWY_EXPORT(Pass16);

namespace {

void dispatched(const LumaView& luma, const PatchJob& job, Sum sum, PatchTotals& out) {
  if (const auto* view = std::get_if<ImageView<std::uint8_t>>(&luma))
    HWY_DYNAMIC_DISPATCH(Pass8)(job, *view, sum, out);
  else
    HWY_DYNAMIC_DISPATCH(Pass16)(job, *std::get_if<ImageView<std::uint16_t>>(&luma), sum, out);
}

}  // namespace

PatchSums sum_patch(const LumaView& luma, const PatchModel& model, const PrintNodes& nodes, const PixelBox& box,
                    NormalMatrix* normal) {
  PatchSums sums;
  PatchTotals totals;
  totals.normal = normal;
  if (normal != nullptr) normal->setZero();
  dispatched(luma, job_of(model, nodes, box, {}), normal == nullptr ? Sum::kRight : Sum::kNormal, totals);
  sums.right = Eigen::Map<const NormalVector>(totals.sums.data());
  sums.left2 = totals.sums[kColumns];
  sums.pixels = totals.pixels;
  if (normal != nullptr) *normal = NormalMatrix(normal->selfadjointView<Eigen::Lower>());
  return sums;
}

ShiftSums sum_shift(const LumaView& luma, const PatchModel& model, const PrintNodes& nodes, const PixelBox& box,
                    const PixelSteps& steps) {
  ShiftSums sums;
  PatchTotals totals;
  dispatched(luma, job_of(model, nodes, box, steps), Sum::kShift, totals);
  std::size_t from = 0;
  for (int i = 0; i < kShiftColumns; ++i) sums.right(i) = totals.sums[from++];
  sums.left2 = totals.sums[from++];
  for (int i = 0; i < kShiftColumns; ++i) {
    for (int j = 0; j <= i; ++j) sums.normal(i, j) = sums.normal(j, i) = totals.sums[from++];
  }
  sums.pixels = totals.pixels;
  return sums;
}

BlockSums sum_blocks(const LumaView& luma, const PatchModel& model, const PrintNodes& nodes, const PixelBox& box,
                     int row_step) {
  BlockSums sums;
  PatchTotals totals;
  totals.blocks = &sums;
  dispatched(luma, job_of(model, nodes, box, {row_step}), Sum::kBlocks, totals);
  return sums;
}

}  // namespace moiregauge::internal
#endif
