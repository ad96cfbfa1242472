// SPDX-License-Identifier: Apache-2.0
// Passes by rows. They sum few columns: those of a shift of the window as a whole, or squared residuals by blocks.
// The file patch_pass.cc includes this one for every SIMD target.
#if defined(MOIREGAUGE_PATCH_ROWS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MOIREGAUGE_PATCH_ROWS_INL_H
#undef MOIREGAUGE_PATCH_ROWS_INL_H
#else
#define MOIREGAUGE_PATCH_ROWS_INL_H
#endif

#include <algorithm>

#include <hwy/highway.h>

#include "moiregauge/image/fetch_row.h"
#include "moiregauge/phase/fit/patch_columns-inl.h"
#include "moiregauge/phase/fit/patch_job.h"

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

static_assert(SomePositions::kMost <= ShiftVectors::kMost);

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

template <Sum kSum, typename Grey>
void pass_by_rows(const PatchJob& job, const ImageView<Grey>& picture, PatchTotals& out) {
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

}  // namespace HWY_NAMESPACE
// NOLINTEND(readability-function-size)
}  // namespace moiregauge::internal
HWY_AFTER_NAMESPACE();

#endif
