// SPDX-License-Identifier: Apache-2.0
// Sums of residuals times columns, of tiles of 16 x 8 pixels and of strips of them.
// The file patch_pass.cc includes this one for every SIMD target.
//
// A column is a quantity q of the pixel times u^i v^j. With homogeneous coordinates, u = U / Z and v = V / Z, this is
// (q / Z^4) U^i V^j Z^(4 - i - j). U, V and Z are linear along an image column. So the sums of (q / Z^4) eta^k, k = 0 to
// 4, determine those of all columns. Here eta is the row's distance from the middle of a strip of rows. A pixel costs
// five sums instead of nine, and the powers are computed once per strip.
#if defined(MOIREGAUGE_PATCH_STRIPS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MOIREGAUGE_PATCH_STRIPS_INL_H
#undef MOIREGAUGE_PATCH_STRIPS_INL_H
#else
#define MOIREGAUGE_PATCH_STRIPS_INL_H
#endif

#include <hwy/highway.h>

#include "moiregauge/phase/fit/patch_columns-inl.h"
#include "moiregauge/phase/fit/patch_job.h"

HWY_BEFORE_NAMESPACE();
namespace moiregauge::internal {
// Vectors are parameters of their own, because some targets do not allow them in structs.
// NOLINTBEGIN(readability-function-size)
namespace HWY_NAMESPACE {

constexpr int kTileRows = 8;
// Tiles that share their strip's sums, so that these and the part of the template stay in the first cache. Chosen.
constexpr int kTilesPerChunk = 8;
constexpr float kEtaRows = 0.5F * kStripRows;  // rows per unit of eta

// Quantities of the rows of a tile: residual, and residual times level and times gain and derivatives. Those of planes
// are divided by Z, those of the field by Z^4.
struct TileRows {
  alignas(64) LaneRow left[kTileRows], plane[kTileRows], t[kTileRows], tx[kTileRows], ty[kTileRows], bx[kTileRows],
      by[kTileRows], edge[kTileRows];

  HWY_INLINE void put(int row, V residual, V gain, V per_z, const Level& l) {
    const Float d;
    const V by_z = hn::Mul(residual, per_z), times_gain = hn::Mul(residual, gain), per_z2 = hn::Mul(per_z, per_z);
    const V by_z4 = hn::Mul(times_gain, hn::Mul(per_z2, per_z2));
    hn::Store(residual, d, left[row]), hn::Store(by_z, d, plane[row]), hn::Store(hn::Mul(l.t, by_z), d, t[row]);
    hn::Store(hn::Mul(l.tx, by_z4), d, tx[row]), hn::Store(hn::Mul(l.ty, by_z4), d, ty[row]);
    hn::Store(hn::Mul(l.bx, times_gain), d, bx[row]), hn::Store(hn::Mul(l.by, times_gain), d, by[row]);
    hn::Store(hn::Mul(l.edge, times_gain), d, edge[row]);
  }
  HWY_INLINE void put_none(int row) {
    const V zero = hn::Zero(Float());
    put(row, zero, zero, zero, {zero, zero, zero, zero, zero, zero});
  }
};

// Sums of a block of image columns over a strip, by powers of eta.
struct StripSums {
  static constexpr int kPlaneMoments = 2, kFieldMoments = 5;
  alignas(64) LaneRow plane[kPlaneMoments], t[kPlaneMoments], tx[kFieldMoments], ty[kFieldMoments], shape[3],
      squares[1];
};

// Rows of a tile: their number, known to the compiler if all are there, and their eta.
template <bool kAll>
struct RowSpan {
  int some;
  float eta[kTileRows];

  HWY_INLINE RowSpan(int rows, float first) : some(rows) {
    for (int row = 0; row < kTileRows; ++row) eta[row] = first + static_cast<float>(row) / kEtaRows;
  }
  [[nodiscard]] HWY_INLINE int count() const { return kAll ? kTileRows : some; }
};

// Adds the rows of a quantity times eta^k, k < kMoments.
template <int kMoments, bool kAll>
HWY_INLINE void add_moments(const LaneRow* rows, const RowSpan<kAll>& span, int lane, LaneRow* sums) {
  const Float d;
  V sum[kMoments];
#pragma GCC unroll 5
  for (int k = 0; k < kMoments; ++k) sum[k] = hn::Load(d, sums[k] + lane);
  for (int row = 0; row < span.count(); ++row) {
    const V at = hn::Set(d, span.eta[row]);
    V value = hn::Load(d, rows[row]);
    sum[0] = hn::Add(sum[0], value);
#pragma GCC unroll 5
    for (int k = 1; k < kMoments; ++k) value = hn::Mul(value, at), sum[k] = hn::Add(sum[k], value);
  }
#pragma GCC unroll 5
  for (int k = 0; k < kMoments; ++k) hn::Store(sum[k], d, sums[k] + lane);
}

template <bool kAll>
HWY_INLINE void add_tile_sums(const TileRows& tile, const RowSpan<kAll>& span, int lane, StripSums& sums) {
  const Float d;
  add_moments<StripSums::kPlaneMoments>(tile.plane, span, lane, sums.plane);
  add_moments<StripSums::kPlaneMoments>(tile.t, span, lane, sums.t);
  add_moments<StripSums::kFieldMoments>(tile.tx, span, lane, sums.tx);
  add_moments<StripSums::kFieldMoments>(tile.ty, span, lane, sums.ty);
  add_moments<1>(tile.bx, span, lane, &sums.shape[0]);
  add_moments<1>(tile.by, span, lane, &sums.shape[1]);
  add_moments<1>(tile.edge, span, lane, &sums.shape[2]);
  V squares = hn::Load(d, sums.squares[0] + lane);
  for (int row = 0; row < span.count(); ++row) {
    const V left = hn::Load(d, tile.left[row]);
    squares = hn::Add(squares, hn::Mul(left, left));
  }
  hn::Store(squares, d, sums.squares[0] + lane);
}

// U, V or Z along an image column: at_0 + per_eta eta.
struct Along {
  V at_0, per_eta;
  // Returns the sum of this times a quantity whose sums with eta^k and eta^(k + 1) are known.
  HWY_INLINE V times(V moment, V next) const { return plus(hn::Mul(at_0, moment), per_eta, next); }
  // Multiplies the quantity, of which `count` sums are known, and leaves one fewer.
  HWY_INLINE void multiply(V* moments, int& count) const {
    --count;
    for (int k = 0; k < count; ++k) moments[k] = times(moments[k], moments[k + 1]);
  }
};
struct Coordinates {
  Along u, v, z;
};

// Adds the sums of a quantity times 1, u and v.
HWY_INLINE void expand_plane(const LaneRow* moments, const Coordinates& at, int lane, LaneRow* to) {
  const Float d;
  const V m0 = hn::Load(d, moments[0] + lane), m1 = hn::Load(d, moments[1] + lane);
  add_to(to[0] + lane, at.z.times(m0, m1)), add_to(to[1] + lane, at.u.times(m0, m1));
  add_to(to[2] + lane, at.v.times(m0, m1));
}

// Adds the sums of a quantity times u^i v^j, i fastest.
HWY_INLINE void expand_moments(const LaneRow* moments, const Coordinates& at, int lane, LaneRow* to) {
  constexpr int kMoments = StripSums::kFieldMoments;
  V by_v[kMoments];
  for (int k = 0; k < kMoments; ++k) by_v[k] = hn::Load(Float(), moments[k] + lane);
  int with_v = kMoments;
#pragma GCC unroll 3
  for (int j = 0; j < 3; ++j) {
    V by_u[kMoments];
    for (int k = 0; k < with_v; ++k) by_u[k] = by_v[k];
    int with_u = with_v;
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
      V by_z[kMoments];
      for (int k = 0; k < with_u; ++k) by_z[k] = by_u[k];
      for (int with_z = with_u; with_z > 1;) at.z.multiply(by_z, with_z);
      add_to(to[3 * j + i] + lane, by_z[0]);
      if (i < 2) at.u.multiply(by_u, with_u);
    }
    if (j < 2) at.v.multiply(by_v, with_v);
  }
}

// Adds a strip's sums of one block of image columns. `dy`, `dx`: middle of the strip, and lanes, px from the middle pixel.
HWY_INLINE void expand_strip(const StripSums& sums, const PatchJob& job, float dy, V dx, int lane, LaneSums& lanes) {
  const Float d;
  const auto along = [&](std::size_t k) {
    const V first = hn::Set(d, job.uv_from_px[k + 2] + job.uv_from_px[k + 1] * dy);
    return Along{plus(first, hn::Set(d, job.uv_from_px[k]), dx), hn::Set(d, kEtaRows * job.uv_from_px[k + 1])};
  };
  const Coordinates at{along(0), along(3), along(6)};
  expand_plane(sums.plane, at, lane, lanes.right);
  expand_plane(sums.t, at, lane, lanes.right + kLightColumns / 2);
  for (int k = 0; k < 3; ++k) add_to(lanes.right[kLightColumns + k] + lane, hn::Load(d, sums.shape[k] + lane));
  expand_moments(sums.tx, at, lane, lanes.right + kBaseColumns);
  expand_moments(sums.ty, at, lane, lanes.right + kBaseColumns + kFieldColumns);
  add_to(lanes.right[kColumns] + lane, hn::Load(d, sums.squares[0] + lane));
}

}  // namespace HWY_NAMESPACE
// NOLINTEND(readability-function-size)
}  // namespace moiregauge::internal
HWY_AFTER_NAMESPACE();

#endif
