// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/raster/pixel_sums.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "moiregauge/image/fetch_row.h"
#include "moiregauge/image/lane_steps.h"
#include "moiregauge/image/simd_options.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "moiregauge/observation/raster/pixel_sums.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace moiregauge::internal {
// Vectors are parameters of their own, because some targets do not allow them in structs.
// NOLINTBEGIN(readability-function-size)
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr int kColumns = 16;  // columns per strip
using Lane = hn::CappedTag<std::uint32_t, kColumns>;
using Lanes = hn::Vec<Lane>;
constexpr int kLanes = static_cast<int>(hn::MaxLanes(Lane()));
// Rows of a band. 32 bits then contain every sum over a column, with 16 bits of grey and the row's number.
constexpr int kBand = 64;

// Pixels of one row with |x - at| <= half, counted from column x0. There are none if half2 < 0.
struct Span {
  std::uint32_t from = 0, count = 0;
};

HWY_INLINE Span span_of(double at, double half2, int x0) {
  if (half2 < 0.0) return {};
  const double half = std::sqrt(half2);
  const int first = static_cast<int>(std::ceil(at - half)), last = static_cast<int>(std::floor(at + half));
  return {static_cast<std::uint32_t>(first - x0), static_cast<std::uint32_t>(std::max(0, last - first + 1))};
}

// The three circles in one row.
struct RowSpans {
  Span window, ring, middle;
};

HWY_INLINE void count_pixels(const RowSpans& spans, int y, DiscSums& out) {
  const std::int64_t n = spans.window.count;
  out.pixels += n, out.y += n * y;
  out.x += n * (2 * static_cast<std::int64_t>(spans.window.from) + n - 1) / 2;
  out.ring_pixels += spans.ring.count, out.middle_pixels += spans.middle.count;
}

HWY_INLINE Lanes within(const Span& span, Lanes x, Lanes value) {
  const Lane d;
  return hn::IfThenElseZero(hn::Lt(hn::Sub(x, hn::Set(d, span.from)), hn::Set(d, span.count)), value);
}

// Sums of one strip's columns over a band.
struct StripSums {
  alignas(64) std::uint32_t window[kColumns], weighted[kColumns], ring[kColumns], middle[kColumns];
};

template <typename Grey>
HWY_INLINE void sum_strip(const ImageView<Grey>& picture, int x0, int y0, int row_step, int first_column,
                          const RowSpans (&spans)[kBand], int rows, StripSums& sums) {
  const Lane d;
  const hn::Rebind<Grey, Lane> small;
  Grey edge[kColumns];
  for (int lane = 0; lane < kColumns; lane += kLanes) {
    Lanes window = hn::Zero(d), weighted = window, ring = window, middle = window;
    const Lanes x =
        hn::Add(hn::Load(d, kLaneSteps<std::uint32_t>), hn::Set(d, static_cast<std::uint32_t>(first_column + lane)));
    for (int r = 0; r < rows; ++r) {
      const Grey* const from = pixels_from(picture, x0 + first_column, y0 + r * row_step, edge) + lane;
      const Lanes grey = hn::PromoteTo(d, hn::LoadU(small, from));
      const Lanes inside = within(spans[r].window, x, grey);
      window = hn::Add(window, inside);
      weighted = hn::Add(weighted, hn::Mul(inside, hn::Set(d, static_cast<std::uint32_t>(r))));
      ring = hn::Add(ring, within(spans[r].ring, x, grey));
      middle = hn::Add(middle, within(spans[r].middle, x, grey));
    }
    hn::Store(window, d, sums.window + lane), hn::Store(weighted, d, sums.weighted + lane);
    hn::Store(ring, d, sums.ring + lane), hn::Store(middle, d, sums.middle + lane);
  }
}

template <typename Grey>
DiscSums sum_disc_in(const ImageView<Grey>& picture, ImagePoint at, const DiscRadii& radii, int row_step) {
  DiscSums out;
  out.x0 = static_cast<int>(std::floor(at.x - radii.window)),
  out.y0 = static_cast<int>(std::floor(at.y - radii.window));
  const int x1 = static_cast<int>(std::ceil(at.x + radii.window));
  const int y1 = static_cast<int>(std::ceil(at.y + radii.window));
  RowSpans spans[kBand];
  StripSums sums;
  for (int first = out.y0; first <= y1; first += kBand * row_step) {
    const int rows = std::min(kBand, (y1 - first) / row_step + 1);
    for (int r = 0; r < rows; ++r) {
      const int y = first + r * row_step;
      fetch_row(picture, y, out.x0, x1);
      const double dy2 = (y - at.y) * (y - at.y);
      const auto span = [&](double radius) { return span_of(at.x, radius * radius - dy2, out.x0); };
      spans[r] = {span(radii.window), span(radii.ring), span(radii.middle)};
      count_pixels(spans[r], y - out.y0, out);
    }
    for (int column = 0; column <= x1 - out.x0; column += kColumns) {
      sum_strip(picture, out.x0, first, row_step, column, spans, rows, sums);
      for (int k = 0; k < kColumns; ++k) {
        const std::int64_t grey = sums.window[k];
        out.grey += grey, out.grey_x += (column + k) * grey;
        out.grey_y += (first - out.y0) * grey + row_step * std::int64_t{sums.weighted[k]};
        out.ring_grey += sums.ring[k], out.middle_grey += sums.middle[k];
      }
    }
  }
  return out;
}

template <typename Grey>
long count_clipped_in(const ImageView<Grey>& picture, int white) {
  const hn::CappedTag<Grey, 64> d;
  constexpr int kStep = static_cast<int>(hn::MaxLanes(hn::CappedTag<Grey, 64>()));
  const auto limit = hn::Set(d, static_cast<Grey>(white)), zero = hn::Zero(d);
  std::size_t clipped = 0;
  for (int y = 0; y < picture.height; ++y) {
    const Grey* const row = picture.row(y).data();
    int x = 0;
    for (; x + kStep <= picture.width; x += kStep) {
      const auto grey = hn::LoadU(d, row + x);
      clipped += hn::CountTrue(d, hn::Or(hn::Eq(grey, zero), hn::Eq(hn::Max(grey, limit), grey)));
    }
    for (; x < picture.width; ++x) clipped += row[x] == 0 || row[x] >= white ? 1 : 0;
  }
  return static_cast<long>(clipped);
}

DiscSums Disc8(const ImageView<std::uint8_t>& p, ImagePoint at, const DiscRadii& radii, int row_step) {
  return sum_disc_in(p, at, radii, row_step);
}
DiscSums Disc16(const ImageView<std::uint16_t>& p, ImagePoint at, const DiscRadii& radii, int row_step) {
  return sum_disc_in(p, at, radii, row_step);
}
long Clipped8(const ImageView<std::uint8_t>& p, int white) { return count_clipped_in(p, white); }
long Clipped16(const ImageView<std::uint16_t>& p, int white) { return count_clipped_in(p, white); }

}  // namespace HWY_NAMESPACE
// NOLINTEND(readability-function-size)
}  // namespace moiregauge::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace moiregauge::internal {
HWY_EXPORT(Disc8);
HWY_EXPORT(Disc16);
HWY_EXPORT(Clipped8);
HWY_EXPORT(Clipped16);

DiscSums sum_disc(const LumaView& luma, ImagePoint at, const DiscRadii& radii, int row_step) {
  if (const auto* view = std::get_if<ImageView<std::uint8_t>>(&luma))
    return HWY_DYNAMIC_DISPATCH(Disc8)(*view, at, radii, row_step);
  return HWY_DYNAMIC_DISPATCH(Disc16)(*std::get_if<ImageView<std::uint16_t>>(&luma), at, radii, row_step);
}

long count_clipped(const LumaView& luma, int white) {
  if (const auto* view = std::get_if<ImageView<std::uint8_t>>(&luma))
    return HWY_DYNAMIC_DISPATCH(Clipped8)(*view, white);
  return HWY_DYNAMIC_DISPATCH(Clipped16)(*std::get_if<ImageView<std::uint16_t>>(&luma), white);
}

}  // namespace moiregauge::internal
#endif
