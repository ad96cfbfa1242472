// SPDX-License-Identifier: Apache-2.0
// Products of all columns with each other, for the normal equations. patch_tiles-inl.h includes this file once for every
// SIMD target.
#if defined(MOIREGAUGE_PATCH_PRODUCTS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MOIREGAUGE_PATCH_PRODUCTS_INL_H
#undef MOIREGAUGE_PATCH_PRODUCTS_INL_H
#else
#define MOIREGAUGE_PATCH_PRODUCTS_INL_H
#endif

#include <hwy/highway.h>

#include "moiregauge/phase/fit/patch_columns-inl.h"
#include "moiregauge/phase/fit/patch_job.h"

HWY_BEFORE_NAMESPACE();
namespace moiregauge::internal {
// Vectors are parameters of their own, because some targets do not allow them in structs.
// NOLINTBEGIN(readability-function-size)
namespace HWY_NAMESPACE {

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

}  // namespace HWY_NAMESPACE
// NOLINTEND(readability-function-size)
}  // namespace moiregauge::internal
HWY_AFTER_NAMESPACE();

#endif
