// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/phase/fit/patch_pass.h"

#include <algorithm>
#include <variant>

#include "moiregauge/image/fetch_row.h"
#include "moiregauge/image/simd_options.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "moiregauge/phase/fit/patch_pass.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "moiregauge/phase/fit/patch_columns-inl.h"
#include "moiregauge/phase/fit/patch_job.h"

HWY_BEFORE_NAMESPACE();
namespace moiregauge::internal {
namespace HWY_NAMESPACE {

HWY_INLINE void add_to(float* sums, V value) {
  const Float d;
  hn::Store(hn::Add(hn::Load(d, sums), value), d, sums);
}

// Values that all pixels of a window share.
struct Patch {
  Table table;
  Plane light, contrast, gain;
  V side, x0, half_x, y0, half_y, one;
  V blur_x, blur_y, width;
  bool has_shape;         // false in a first pass
  V row_x, row_y, row_z;  // changes of u z, v z and z from one pixel of a row to the next

  explicit Patch(const PatchJob& job) : table(*job.table), light(job.light), contrast(job.contrast), gain(job.gain) {
    const auto set = [](float value) { return hn::Set(Float(), value); };
    side = table.side, one = table.one;
    blur_x = set(job.shape[0]), blur_y = set(job.shape[1]), width = set(job.shape[2]);
    has_shape = job.shape != std::array<float, 3>{};
    x0 = set(job.nodes[0]), half_x = set(job.nodes[1]), y0 = set(job.nodes[2]), half_y = set(job.nodes[3]);
    row_x = set(job.uv_from_px[0]), row_y = set(job.uv_from_px[3]), row_z = set(job.uv_from_px[6]);
  }
};

// Values u z, v z and z at the middle of a row.
struct Row {
  V x, y, z;
  Row(const PatchJob& job, float dy) {
    const auto at = [&](std::size_t k) { return hn::Set(Float(), job.uv_from_px[k + 2] + job.uv_from_px[k + 1] * dy); };
    x = at(0), y = at(3), z = at(6);
  }
};

template <Sum kSum>
using Registers = V[registers_of(kSum)];

// Adds to the sums of a shift. `left`: residual, zero outside the window.
HWY_INLINE void add_shift(V left, V inside, const Level& l, Registers<Sum::kShift>& sums) {
  const V c[kShiftColumns] = {inside, hn::Mul(l.t, inside), hn::Mul(l.tx, inside), hn::Mul(l.ty, inside)};
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

// Blocks of a row whose sums are pending. All sums at once would not fit into registers, so each group of them runs
// through the blocks on its own.
struct Pending {
  static constexpr int kMost = 16;
  int blocks = 0;
  // Position in the window, and residual times 1 and times each quantity of the level.
  alignas(64) float u[kMost][kBlockWidth], v[kMost][kBlockWidth], left[kMost][kBlockWidth], t[kMost][kBlockWidth],
      tx[kMost][kBlockWidth], ty[kMost][kBlockWidth], bx[kMost][kBlockWidth], by[kMost][kBlockWidth],
      edge[kMost][kBlockWidth];

  HWY_INLINE void put(V residual, const Level& l, V at_u, V at_v) {
    const Float d;
    const Level part = times(l, residual);
    hn::Store(at_u, d, u[blocks]), hn::Store(at_v, d, v[blocks]), hn::Store(residual, d, left[blocks]);
    hn::Store(part.t, d, t[blocks]), hn::Store(part.tx, d, tx[blocks]), hn::Store(part.ty, d, ty[blocks]);
    hn::Store(part.bx, d, bx[blocks]), hn::Store(part.by, d, by[blocks]), hn::Store(part.edge, d, edge[blocks]);
    ++blocks;
  }
};

using LaneRow = float[kBlockWidth];

// Registers for kCount sums from `first` on, which go back to memory at the end.
template <int kCount>
struct SumGroup {
  V sums[kCount];
  LaneRow* memory;
  int lane;
  HWY_INLINE SumGroup(LaneSums& lanes, int first, int at) : memory(lanes.right + first), lane(at) {
    for (int k = 0; k < kCount; ++k) sums[k] = hn::Load(Float(), memory[k] + lane);
  }
  HWY_INLINE void keep() const {
    for (int k = 0; k < kCount; ++k) hn::Store(sums[k], Float(), memory[k] + lane);
  }
  HWY_INLINE void add(int k, V value) { sums[k] = hn::Add(sums[k], value); }
};

HWY_INLINE void add_field(const Pending& pending, const LaneRow* slopes, int first, int lane, LaneSums& lanes) {
  const Float d;
  SumGroup<kFieldColumns> group(lanes, first, lane);
  for (int b = 0; b < pending.blocks; ++b)
    expand_field<0>(hn::Load(d, slopes[b]), hn::Load(d, pending.u[b]), hn::Load(d, pending.v[b]),
                    [&group](int k, V value) { group.add(k, value); });
  group.keep();
}

// Adds three sums: of a quantity, and of its products with u and v.
HWY_INLINE void add_plane(const Pending& pending, const LaneRow* values, int first, int lane, LaneSums& lanes) {
  const Float d;
  SumGroup<3> group(lanes, first, lane);
  for (int b = 0; b < pending.blocks; ++b) {
    const V value = hn::Load(d, values[b]);
    group.add(0, value);
    group.add(1, hn::Mul(value, hn::Load(d, pending.u[b])));
    group.add(2, hn::Mul(value, hn::Load(d, pending.v[b])));
  }
  group.keep();
}

// Adds the sums of blur and width, and the squared residuals.
HWY_INLINE void add_shape(const Pending& pending, int lane, LaneSums& lanes) {
  const Float d;
  SumGroup<kBlurColumns + kWidthColumns> shape(lanes, kLightColumns, lane);
  SumGroup<1> squares(lanes, kColumns, lane);
  for (int b = 0; b < pending.blocks; ++b) {
    const V left = hn::Load(d, pending.left[b]);
    shape.add(0, hn::Load(d, pending.bx[b])), shape.add(1, hn::Load(d, pending.by[b]));
    shape.add(2, hn::Load(d, pending.edge[b]));
    squares.add(0, hn::Mul(left, left));
  }
  shape.keep(), squares.keep();
}

HWY_INLINE void add_pending(Pending& pending, int lane, LaneSums& lanes) {
  add_plane(pending, pending.left, 0, lane, lanes);
  add_plane(pending, pending.t, kLightColumns / 2, lane, lanes);
  add_shape(pending, lane, lanes);
  add_field(pending, pending.tx, kBaseColumns, lane, lanes);
  add_field(pending, pending.ty, kBaseColumns + kFieldColumns, lane, lanes);
  pending.blocks = 0;
}

HWY_INLINE void add_normal(V inside, const Level& l, V u, V v, int lane, LaneSums& sums) {
  V c[kColumns];
  expand(inside, times(l, inside), u, v, [&c](int k, V value) { c[k] = value; });
  float* to = sums.normal[0] + lane;
  for (int i = 0; i < kColumns; ++i) {
    for (int j = 0; j <= i; ++j, to += kBlockWidth) add_to(to, hn::Mul(c[i], c[j]));
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

// Adds a block of pixels and returns the number inside the window. `grey`: grey levels of the lanes. `dx`: distances of
// the lanes from the middle pixel, px. `there`: lanes inside the box.
template <Sum kSum, typename Mask>
HWY_INLINE int add_block(const Patch& patch, const Row& row, V grey, V dx, Mask there, int lane, LaneSums& lanes,
                         Registers<kSum>& sums, Pending& pending) {
  const Float d;
  const V z = hn::Div(patch.one, plus(row.z, patch.row_z, dx));
  const V u = hn::Mul(plus(row.x, patch.row_x, dx), z), v = hn::Mul(plus(row.y, patch.row_y, dx), z);
  const auto in = hn::And(there, hn::Le(hn::Max(hn::Abs(u), hn::Abs(v)), patch.one));
  if (hn::AllFalse(d, in)) return 0;
  Level l = patch.table.at(plus(patch.x0, u, patch.half_x), plus(patch.y0, v, patch.half_y));
  const V gain = hn::Mul(patch.gain(u, v), patch.side), bend = hn::Mul(gain, patch.side);
  l = {l.t, hn::Mul(l.tx, gain), hn::Mul(l.ty, gain), hn::Mul(l.bx, bend), hn::Mul(l.by, bend), hn::Mul(l.edge, bend)};
  V shown = plus(patch.light(u, v), patch.contrast(u, v), l.t);
  if (patch.has_shape) shown = plus(plus(plus(shown, patch.blur_x, l.bx), patch.blur_y, l.by), patch.width, l.edge);
  const V left = hn::IfThenElseZero(in, hn::Sub(grey, shown));
  const V inside = hn::IfThenElseZero(in, patch.one);
  if constexpr (kSum == Sum::kBlocks) {
    sums[0] = hn::Add(sums[0], hn::Mul(left, left));
    add_blocks(left, in, u, v, lane, lanes);
  } else if constexpr (kSum == Sum::kShift) {
    add_shift(left, inside, l, sums);
  } else {
    pending.put(left, l, u, v);
    if constexpr (kSum == Sum::kNormal) add_normal(inside, l, u, v, lane, lanes);
  }
  return static_cast<int>(hn::CountTrue(d, in));
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

template <Sum kSum, typename Grey>
int add_band(const PatchJob& job, const Patch& patch, const ImageView<Grey>& picture, int first, int last,
             LaneSums& lanes) {
  const Float d;
  const V step = hn::Set(d, float{kBlockWidth});
  Grey edge[kBlockWidth];
  Pending pending;
  if constexpr (is_pending(kSum)) std::fill_n(&lanes.right[0][0], (kColumns + 1) * kBlockWidth, 0.0F);
  int pixels = 0;
  for (int lane = 0; lane < kBlockWidth; lane += kLanes) {
    Registers<kSum> sums;
    for (int k = 0; k < registers_of(kSum); ++k) sums[k] = hn::Zero(d);
    for (int y = first; y <= last; y += job.row_step) {
      const Row row(job, static_cast<float>(y - job.y));
      const int ahead = y + kRowsAhead * job.row_step;
      if (lane == 0 && ahead <= job.box.y1) fetch_row(picture, ahead, job.box.x0, job.box.x1);
      V dx = hn::Iota(d, static_cast<float>(job.box.x0 - job.x + lane));
      V left = hn::Sub(hn::Set(d, static_cast<float>(job.box.x1 - job.x)), dx);
      for (int x = job.box.x0; x <= job.box.x1; x += kBlockWidth) {
        const V grey = greys(pixels_from(picture, x, y, edge) + lane);
        pixels += add_block<kSum>(patch, row, grey, dx, hn::Ge(left, hn::Zero(d)), lane, lanes, sums, pending);
        dx = hn::Add(dx, step), left = hn::Sub(left, step);
        if constexpr (is_pending(kSum)) {
          if (pending.blocks == Pending::kMost) add_pending(pending, lane, lanes);
        }
      }
    }
    if constexpr (is_pending(kSum))
      add_pending(pending, lane, lanes);
    else
      for (int k = 0; k < registers_of(kSum); ++k) hn::Store(sums[k], d, lanes.right[k] + lane);
  }
  return pixels;
}

template <Sum kSum, typename Grey>
void pass(const PatchJob& job, const ImageView<Grey>& picture, PatchTotals& out) {
  LaneSums lanes;
  const Patch patch(job);
  const int band = kBandRows * job.row_step;
  if constexpr (kSum == Sum::kBlocks) {
    std::fill_n(&lanes.squares[0][0], out.blocks->squares.size() * kBlockWidth, 0.0F);
    std::fill_n(lanes.pixels, out.blocks->pixels.size(), 0);
  }
  for (int y = job.box.y0; y <= job.box.y1; y += band) {
    if constexpr (kSum == Sum::kNormal) std::fill_n(&lanes.normal[0][0], kProducts * kBlockWidth, 0.0F);
    out.pixels += add_band<kSum>(job, patch, picture, y, std::min(y + band - 1, job.box.y1), lanes);
    for (int k = 0; k < sums_of(kSum); ++k) out.sums[static_cast<std::size_t>(k)] += folded(lanes.right[k]);
    if constexpr (kSum == Sum::kNormal) {
      for (int i = 0, k = 0; i < kColumns; ++i) {
        for (int j = 0; j <= i; ++j, ++k) (*out.normal)(i, j) += folded(lanes.normal[k]);
      }
    }
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
      return pass<Sum::kRight>(job, picture, out);
    case Sum::kNormal:
      return pass<Sum::kNormal>(job, picture, out);
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

void sum_patch(const LumaView& luma, const PatchModel& model, const PrintNodes& nodes, const PixelBox& box,
               PatchSums& sums, NormalMatrix* normal) {
  PatchTotals totals;
  totals.normal = normal;
  if (normal != nullptr) normal->setZero();
  dispatched(luma, job_of(model, nodes, box, 1), normal == nullptr ? Sum::kRight : Sum::kNormal, totals);
  sums.right = Eigen::Map<const NormalVector>(totals.sums.data());
  sums.left2 = totals.sums[kColumns];
  sums.pixels = totals.pixels;
  if (normal != nullptr) *normal = NormalMatrix(normal->selfadjointView<Eigen::Lower>());
}

void sum_shift(const LumaView& luma, const PatchModel& model, const PrintNodes& nodes, const PixelBox& box,
               int row_step, ShiftSums& sums) {
  PatchTotals totals;
  dispatched(luma, job_of(model, nodes, box, row_step), Sum::kShift, totals);
  std::size_t from = 0;
  for (int i = 0; i < kShiftColumns; ++i) sums.right(i) = totals.sums[from++];
  sums.left2 = totals.sums[from++];
  for (int i = 0; i < kShiftColumns; ++i) {
    for (int j = 0; j <= i; ++j) sums.normal(i, j) = sums.normal(j, i) = totals.sums[from++];
  }
  sums.pixels = totals.pixels;
}

void sum_blocks(const LumaView& luma, const PatchModel& model, const PrintNodes& nodes, const PixelBox& box,
                int row_step, BlockSums& sums) {
  PatchTotals totals;
  totals.blocks = &sums;
  dispatched(luma, job_of(model, nodes, box, row_step), Sum::kBlocks, totals);
}

}  // namespace moiregauge::internal
#endif
