// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/circles/threshold_rows.h"

#include <algorithm>
#include <cstring>

#include "moiregauge/image/simd_options.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "moiregauge/detection/circles/threshold_rows.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace moiregauge::internal::markers_detail {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Word = hn::CappedTag<std::uint16_t, 32>;
using Byte = hn::Rebind<std::uint8_t, Word>;  // as many lanes as Word
using Words = hn::Vec<Word>;
constexpr int kWords = static_cast<int>(hn::MaxLanes(Word()));
constexpr int kColumns = kStripPx + 32;  // px: a strip, one column to either side, and the rest of the last vector
constexpr std::uint16_t kMaxSum = 16 * 255;

// Six rows of a strip (those of a tile, one above, one below), starting one column before the strip.
struct StripRows {
  const std::uint8_t* row[kTilePx + 2];
  std::uint8_t copy[kTilePx + 2][kColumns];
};

int mirrored(int i, int count) { return i < 0 ? -i : i < count ? i : std::max(0, 2 * count - 2 - i); }

// Points `strip` to the rows of the image, or to copies with mirrored columns if the strip touches the image's edge.
void take_rows(const GreyView& picture, int x0, int tile_y, StripRows& strip) {
  const int before = x0 - 1, columns = std::min(kColumns, picture.width + 1 - before);
  const bool inside = before >= 0 && before + kColumns <= picture.width;
  for (int r = 0; r < kTilePx + 2; ++r) {
    const std::uint8_t* const row = picture.data + mirrored(tile_y * kTilePx + r - 1, picture.height) * picture.stride;
    strip.row[r] = inside ? row + before : strip.copy[r];
    if (inside) continue;
    const int first = std::max(before, 0), last = std::min(before + columns, picture.width);
    std::copy(row + first, row + last, strip.copy[r] + (first - before));
    if (before < 0) strip.copy[r][0] = row[mirrored(before, picture.width)];
    for (int x = last; x < before + columns; ++x) strip.copy[r][x - before] = row[mirrored(x, picture.width)];
    std::fill(strip.copy[r] + columns, strip.copy[r] + kColumns, std::uint8_t{0});
  }
}

using ColumnSums = std::uint16_t[kTilePx][kColumns];

HWY_INLINE void sum_columns(const StripRows& strip, ColumnSums& sums) {
  const Word d;
  const Byte d8;
  for (int x = 0; x < kColumns; x += kWords) {
    Words pair[kTilePx + 1];
    Words upper = hn::PromoteTo(d, hn::LoadU(d8, strip.row[0] + x));
    for (int r = 0; r <= kTilePx; ++r) {
      const Words lower = hn::PromoteTo(d, hn::LoadU(d8, strip.row[r + 1] + x));
      pair[r] = hn::Add(upper, lower);
      upper = lower;
    }
    for (int r = 0; r < kTilePx; ++r) hn::StoreU(hn::Add(pair[r], pair[r + 1]), d, sums[r] + x);
  }
}

HWY_INLINE Words sixteenfold(const std::uint16_t* sums) {
  const Word d;
  const Words middle = hn::LoadU(d, sums + 1);
  return hn::Add(hn::Add(hn::LoadU(d, sums), hn::LoadU(d, sums + 2)), hn::Add(middle, middle));
}

// Divides weighted sums (total weight 16) by 16, rounded, and stores them as bytes.
HWY_INLINE void store_means(Words sums, std::uint8_t* out) {
  const Words mean = hn::ShiftRight<4>(hn::Add(sums, hn::Set(Word(), 8)));
  hn::StoreU(hn::TruncateTo(Byte(), mean), Byte(), out);
}

void TileRowExtremes(const GreyView& picture, int tile_y, std::uint8_t* low, std::uint8_t* high) {
  const Word d;
  const int rows = std::min(kTilePx, picture.height - tile_y * kTilePx);
  StripRows strip;
  ColumnSums sums;
  std::uint16_t smallest[kStripPx], largest[kStripPx];
  for (int x0 = 0; x0 < picture.width; x0 += kStripPx, low += kStripTiles, high += kStripTiles) {
    take_rows(picture, x0, tile_y, strip);
    sum_columns(strip, sums);
    for (int x = 0; x < kStripPx; x += kWords) {
      Words s = sixteenfold(sums[0] + x), l = s;
      for (int r = 1; r < rows; ++r) {
        const Words next = sixteenfold(sums[r] + x);
        s = hn::Min(s, next);
        l = hn::Max(l, next);
      }
      hn::StoreU(s, d, smallest + x);
      hn::StoreU(l, d, largest + x);
    }
    for (int x = picture.width - x0; x < kStripPx; ++x) smallest[x] = kMaxSum, largest[x] = 0;
    for (int t = 0; t < kStripTiles; t += kWords) {
      Words s[kTilePx], l[kTilePx];
      hn::LoadInterleaved4(d, smallest + t * kTilePx, s[0], s[1], s[2], s[3]);
      hn::LoadInterleaved4(d, largest + t * kTilePx, l[0], l[1], l[2], l[3]);
      store_means(hn::Min(hn::Min(s[0], s[1]), hn::Min(s[2], s[3])), low + t);
      store_means(hn::Max(hn::Max(l[0], l[1]), hn::Max(l[2], l[3])), high + t);
    }
  }
}

void TileRowThreshold(const ThreeTileRows& rows, int strips, int min_contrast, std::uint8_t* threshold) {
  const hn::CappedTag<std::uint8_t, kStripTiles> d;
  const auto flat = hn::Set(d, static_cast<std::uint8_t>(min_contrast - 1));
  for (int t = 0; t < strips * kStripTiles; t += static_cast<int>(hn::MaxLanes(d))) {
    auto low = hn::Set(d, 255), high = hn::Zero(d);
    for (int r = 0; r < 3; ++r) {
      for (int x = t - 1; x <= t + 1; ++x) {
        low = hn::Min(low, hn::LoadU(d, rows.low[r] + x));
        high = hn::Max(high, hn::LoadU(d, rows.high[r] + x));
      }
    }
    const auto middle = hn::AverageRound(low, high), own = hn::LoadU(d, rows.low[1] + t);
    const auto there = hn::And(hn::Gt(hn::SaturatedSub(high, low), flat), hn::Lt(own, middle));
    hn::StoreU(hn::IfThenElseZero(there, middle), d, threshold + t);
  }
}

void DarkStrip(const GreyView& picture, Tile first, const std::uint8_t* threshold, std::uint8_t* dark,
               std::ptrdiff_t stride) {
  const Byte d8;
  const int rows = std::min(kTilePx, picture.height - first.y * kTilePx);
  StripRows strip;
  ColumnSums sums;
  take_rows(picture, first.x * kTilePx, first.y, strip);
  sum_columns(strip, sums);
  std::uint8_t level[kStripPx];
  for (int t = 0; t < kStripTiles; ++t) std::memset(level + t * kTilePx, threshold[t], kTilePx);
  for (int r = 0; r < rows; ++r, dark += stride) {
    for (int x = 0; x < kStripPx; x += kWords) {
      const Words mean = hn::ShiftRight<4>(hn::Add(sixteenfold(sums[r] + x), hn::Set(Word(), 8)));
      const auto smooth = hn::TruncateTo(d8, mean);
      hn::StoreU(hn::IfThenElseZero(hn::Lt(smooth, hn::LoadU(d8, level + x)), hn::Set(d8, 1)), d8, dark + x);
    }
  }
}

HWY_INLINE Words pairs(const std::uint8_t* row) {
  const Word d;
  hn::Vec<Byte> even, odd;
  hn::LoadInterleaved2(Byte(), row, even, odd);
  return hn::Add(hn::PromoteTo(d, even), hn::PromoteTo(d, odd));
}

HWY_INLINE Words fours(const std::uint8_t* row) {
  const Word d;
  hn::Vec<Byte> v[kTilePx];
  hn::LoadInterleaved4(Byte(), row, v[0], v[1], v[2], v[3]);
  return hn::Add(hn::Add(hn::PromoteTo(d, v[0]), hn::PromoteTo(d, v[1])),
                 hn::Add(hn::PromoteTo(d, v[2]), hn::PromoteTo(d, v[3])));
}

void HalveRow(const std::uint8_t* upper, const std::uint8_t* lower, int halves, std::uint8_t* out) {
  const Word d;
  const Byte d8;
  int x = 0;
  for (; x + kWords <= halves; x += kWords) {
    const Words sum = hn::Add(hn::Add(pairs(upper + 2 * x), pairs(lower + 2 * x)), hn::Set(d, 2));
    hn::StoreU(hn::TruncateTo(d8, hn::ShiftRight<2>(sum)), d8, out + x);
  }
  for (; x < halves; ++x) {
    const int sum = upper[2 * x] + upper[2 * x + 1] + lower[2 * x] + lower[2 * x + 1];
    out[x] = static_cast<std::uint8_t>((sum + 2) / 4);
  }
}

void TileRowSums(const GreyView& picture, int tile_y, TileSums& sums) {
  const Word d;
  const std::uint8_t* const row = picture.data + tile_y * kTilePx * picture.stride;
  const int whole = picture.width / kTilePx * kTilePx;
  Words smallest = hn::Set(d, kMaxSum), largest = hn::Zero(d);
  int x = 0;
  for (; x + kTilePx * kWords <= whole; x += kTilePx * kWords) {
    Words sum = fours(row + x);
    for (int r = 1; r < kTilePx; ++r) sum = hn::Add(sum, fours(row + r * picture.stride + x));
    smallest = hn::Min(smallest, sum);
    largest = hn::Max(largest, sum);
  }
  std::uint16_t lanes[2][kWords];
  hn::StoreU(smallest, d, lanes[0]);
  hn::StoreU(largest, d, lanes[1]);
  sums.smallest = std::min<int>(sums.smallest, *std::min_element(lanes[0], lanes[0] + kWords));
  sums.largest = std::max<int>(sums.largest, *std::max_element(lanes[1], lanes[1] + kWords));
  for (; x < whole; x += kTilePx) {
    int sum = 0;
    for (int i = 0; i < kTilePx * kTilePx; ++i) sum += row[i / kTilePx * picture.stride + x + i % kTilePx];
    sums.smallest = std::min(sums.smallest, sum);
    sums.largest = std::max(sums.largest, sum);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace moiregauge::internal::markers_detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace moiregauge::internal::markers_detail {

HWY_EXPORT(TileRowExtremes);
HWY_EXPORT(TileRowThreshold);
HWY_EXPORT(DarkStrip);
HWY_EXPORT(HalveRow);
HWY_EXPORT(TileRowSums);

void tile_row_extremes(const GreyView& picture, int tile_y, std::uint8_t* low, std::uint8_t* high) {
  HWY_DYNAMIC_DISPATCH(TileRowExtremes)(picture, tile_y, low, high);
}
void tile_row_threshold(const ThreeTileRows& rows, int strips, int min_contrast, std::uint8_t* threshold) {
  HWY_DYNAMIC_DISPATCH(TileRowThreshold)(rows, strips, min_contrast, threshold);
}
void dark_strip(const GreyView& picture, Tile first, const std::uint8_t* threshold, std::uint8_t* dark,
                std::ptrdiff_t stride) {
  HWY_DYNAMIC_DISPATCH(DarkStrip)(picture, first, threshold, dark, stride);
}
void halve_row(const std::uint8_t* upper, const std::uint8_t* lower, int halves, std::uint8_t* out) {
  HWY_DYNAMIC_DISPATCH(HalveRow)(upper, lower, halves, out);
}
void tile_row_sums(const GreyView& picture, int tile_y, TileSums& sums) {
  HWY_DYNAMIC_DISPATCH(TileRowSums)(picture, tile_y, sums);
}

}  // namespace moiregauge::internal::markers_detail
#endif
