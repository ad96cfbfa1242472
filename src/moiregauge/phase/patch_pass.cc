// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/phase/patch_pass.h"

#include <algorithm>
#include <variant>

#include <hwy/cache_control.h>

#define HWY_COMPILE_ALL_ATTAINABLE  // the scalar one too: it is what the others are compared with
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "moiregauge/phase/patch_pass.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef MOIREGAUGE_PATCH_JOB
#define MOIREGAUGE_PATCH_JOB
namespace moiregauge {

constexpr int kBlockWidth = 16;
// Single precision holds the sums of so many rows; then they go into doubles.
constexpr int kBandRows = 16;
constexpr int kProducts = kColumns * (kColumns + 1) / 2;
constexpr int kShiftProducts = kShiftColumns * (kShiftColumns + 1) / 2;
enum class Sum {
  kRight,   // times each column, and squared
  kNormal,  // also the columns' products
  kShift    // of the patch as a whole: times each of its columns, squared, and these columns' products
};
// How many of them are kept in registers.
constexpr int registers_of(Sum sum) { return sum == Sum::kShift ? kShiftColumns + 1 + kShiftProducts : kColumns + 1; }

// (u, v) of pixels by their distance from the patch's middle pixel: numbers near 1, so that single precision will do.
struct PatchJob {
  std::array<float, 9> uv_from_px{};  // a homography, row by row, its last element 1
  int x = 0, y = 0;                   // of the middle pixel
  std::array<float, 3> light{}, contrast{}, gain{};
  std::array<float, 4> nodes{};  // print coordinates in nodes: [0] + u [1], [2] + v [3]
  const PrintNodes* table = nullptr;
  PixelBox box;
  int row_step = 1;
};

// Sixteen lanes of every sum.
struct LaneSums {
  alignas(64) float right[kColumns + 1][kBlockWidth];  // in order of registers
  alignas(64) float normal[kProducts][kBlockWidth];  // lower triangle, row by row
};

// In the order of the registers.
struct PatchTotals {
  std::array<double, kColumns + 1> sums{};
  NormalMatrix* normal = nullptr;
  int pixels = 0;
};

}  // namespace moiregauge
#endif

HWY_BEFORE_NAMESPACE();
namespace moiregauge {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Float = hn::CappedTag<float, kBlockWidth>;
using Whole = hn::RebindToSigned<Float>;
using V = hn::Vec<Float>;
constexpr int kLanes = static_cast<int>(hn::MaxLanes(Float()));

HWY_INLINE V plus(V a, V b, V c) { return hn::Add(a, hn::Mul(b, c)); }  // not MulAdd: it rounds once where it can

struct Plane {
  V at_0, per_u, per_v;
  explicit Plane(const std::array<float, 3>& c)
      : at_0(hn::Set(Float(), c[0])), per_u(hn::Set(Float(), c[1])), per_v(hn::Set(Float(), c[2])) {}
  HWY_INLINE V operator()(V u, V v) const { return plus(plus(at_0, per_u, u), per_v, v); }
};

struct Level {
  V t, tx, ty, bx, by;  // by nodes
};

// PrintTemplate::at
struct Table {
  const std::int32_t* words;
  V side, per_side, wide, words_per_node, one;
  V scale[2 * PrintNodes::kWords];

  explicit Table(const PrintNodes& nodes) : words(nodes.words.data()) {
    const auto set = [](auto value) { return hn::Set(Float(), static_cast<float>(value)); };
    side = set(nodes.side), per_side = set(1.0F / static_cast<float>(nodes.side)), wide = set(nodes.wide());
    words_per_node = set(PrintNodes::kWords), one = set(1);
    for (int k = 0; k < 2 * PrintNodes::kWords; ++k) scale[k] = set(nodes.scale[static_cast<std::size_t>(k)]);
  }

  // The table begins a node before the period.
  HWY_INLINE V node_of(V whole) const {
    return hn::Add(hn::Sub(whole, hn::Mul(side, hn::Floor(hn::Mul(whole, per_side)))), one);
  }

  HWY_INLINE Level at(V x, V y) const {
    const Float d;
    const Whole di;
    const V i = hn::Round(x), j = hn::Round(y), u = hn::Sub(x, i), v = hn::Sub(y, j);
    const auto node = hn::ConvertTo(di, hn::Mul(plus(node_of(i), node_of(j), wide), words_per_node));
    V a[2 * PrintNodes::kWords];
#pragma GCC unroll 3
    for (int w = 0; w < PrintNodes::kWords; ++w) {
      const auto word = hn::GatherIndex(di, words + w, node);
      a[2 * w] = hn::Mul(hn::ConvertTo(d, hn::ShiftRight<16>(hn::ShiftLeft<16>(word))), scale[2 * w]);
      a[2 * w + 1] = hn::Mul(hn::ConvertTo(d, hn::ShiftRight<16>(word)), scale[2 * w + 1]);
    }
    const V bx = hn::Add(a[3], a[3]), by = hn::Add(a[5], a[5]);
    return {plus(plus(a[0], u, plus(plus(a[1], u, a[3]), v, a[4])), v, plus(a[2], v, a[5])),
            plus(plus(a[1], u, bx), v, a[4]), plus(plus(a[2], v, by), u, a[4]), bx, by};
  }
};

HWY_INLINE V greys(const std::uint8_t* from) {
  const hn::Rebind<std::uint8_t, Float> d8;
  return hn::ConvertTo(Float(), hn::PromoteTo(Whole(), hn::LoadU(d8, from)));
}
HWY_INLINE V greys(const std::uint16_t* from) {
  const hn::Rebind<std::uint16_t, Float> d16;
  return hn::ConvertTo(Float(), hn::PromoteTo(Whole(), hn::LoadU(d16, from)));
}

template <int kFirst, typename Put>
HWY_INLINE void expand_field(V slope, V u, V v, const Put& put) {
  for (int j = 0; j < 3; ++j) {
    const V once = hn::Mul(slope, u);
    put(kFirst + 3 * j, slope), put(kFirst + 3 * j + 1, once), put(kFirst + 3 * j + 2, hn::Mul(once, u));
    slope = hn::Mul(slope, v);
  }
}

// The columns, all times `one`, which the level holds already.
template <typename Put>
HWY_INLINE void expand(V one, const Level& l, V u, V v, const Put& put) {
  put(0, one), put(1, hn::Mul(one, u)), put(2, hn::Mul(one, v));
  put(3, l.t), put(4, hn::Mul(l.t, u)), put(5, hn::Mul(l.t, v));
  put(6, l.bx), put(7, l.by);
  expand_field<kBaseColumns>(l.tx, u, v, put);
  expand_field<kBaseColumns + kFieldColumns>(l.ty, u, v, put);
}

HWY_INLINE Level times(const Level& l, V f) {
  return {hn::Mul(l.t, f), hn::Mul(l.tx, f), hn::Mul(l.ty, f), hn::Mul(l.bx, f), hn::Mul(l.by, f)};
}

HWY_INLINE void add_to(float* sums, V value) {
  const Float d;
  hn::Store(hn::Add(hn::Load(d, sums), value), d, sums);
}

// What all pixels of a patch share.
struct Patch {
  Table table;
  Plane light, contrast, gain;
  V side, x0, half_x, y0, half_y, one;
  V row_x, row_y, row_z;  // by which u z, v z and z change along a row

  explicit Patch(const PatchJob& job)
      : table(*job.table), light(job.light), contrast(job.contrast), gain(job.gain) {
    const auto set = [](float value) { return hn::Set(Float(), value); };
    side = table.side, one = table.one;
    x0 = set(job.nodes[0]), half_x = set(job.nodes[1]), y0 = set(job.nodes[2]), half_y = set(job.nodes[3]);
    row_x = set(job.uv_from_px[0]), row_y = set(job.uv_from_px[3]), row_z = set(job.uv_from_px[6]);
  }
};

// The same of a row, where its middle is.
struct Row {
  V x, y, z;
  Row(const PatchJob& job, float dy) {
    const auto at = [&](std::size_t k) { return hn::Set(Float(), job.uv_from_px[k + 2] + job.uv_from_px[k + 1] * dy); };
    x = at(0), y = at(3), z = at(6);
  }
};

template <Sum kSum>
using Registers = V[registers_of(kSum)];

// `left`: of the grey levels, nothing outside the window.
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

HWY_INLINE void add_right(V left, const Level& l, V u, V v, Registers<Sum::kRight>& sums) {
  sums[kColumns] = hn::Add(sums[kColumns], hn::Mul(left, left));
  expand(left, times(l, left), u, v, [&sums](int k, V value) { sums[k] = hn::Add(sums[k], value); });
}

HWY_INLINE void add_normal(V inside, const Level& l, V u, V v, int lane, LaneSums& sums) {
  V c[kColumns];
  expand(inside, times(l, inside), u, v, [&c](int k, V value) { c[k] = value; });
  float* to = sums.normal[0] + lane;
  for (int i = 0; i < kColumns; ++i) {
    for (int j = 0; j <= i; ++j, to += kBlockWidth) add_to(to, hn::Mul(c[i], c[j]));
  }
}

// `grey`: of the lanes; `dx`: of the lanes from the middle pixel; `there`: those in the box.
template <Sum kSum, typename Mask>
HWY_INLINE int add_block(const Patch& patch, const Row& row, V grey, V dx, Mask there, int lane, LaneSums& lanes,
                         Registers<kSum>& sums) {
  const Float d;
  const V z = hn::Div(patch.one, plus(row.z, patch.row_z, dx));
  const V u = hn::Mul(plus(row.x, patch.row_x, dx), z), v = hn::Mul(plus(row.y, patch.row_y, dx), z);
  const auto in = hn::And(there, hn::Le(hn::Max(hn::Abs(u), hn::Abs(v)), patch.one));
  if (hn::AllFalse(d, in)) return 0;
  Level l = patch.table.at(plus(patch.x0, u, patch.half_x), plus(patch.y0, v, patch.half_y));
  const V left = hn::IfThenElseZero(
      in, hn::Sub(hn::Sub(grey, patch.light(u, v)), hn::Mul(patch.contrast(u, v), l.t)));
  const V gain = hn::Mul(patch.gain(u, v), patch.side), bend = hn::Mul(gain, patch.side);
  l = {l.t, hn::Mul(l.tx, gain), hn::Mul(l.ty, gain), hn::Mul(l.bx, bend), hn::Mul(l.by, bend)};
  const V inside = hn::IfThenElseZero(in, patch.one);
  if constexpr (kSum == Sum::kShift) {
    add_shift(left, inside, l, sums);
  } else {
    add_right(left, l, u, v, sums);
    if constexpr (kSum == Sum::kNormal) add_normal(inside, l, u, v, lane, lanes);
  }
  return static_cast<int>(hn::CountTrue(d, in));
}

// Sixteen lanes into one, by halves.
HWY_INLINE double folded(float* lanes) {
  const hn::CappedTag<float, 4> d;
  for (int half = kBlockWidth / 2; half >= 4; half /= 2) {
    for (int i = 0; i < half; i += static_cast<int>(hn::MaxLanes(d)))
      hn::Store(hn::Add(hn::Load(d, lanes + i), hn::Load(d, lanes + i + half)), d, lanes + i);
  }
  return static_cast<double>((lanes[0] + lanes[2]) + (lanes[1] + lanes[3]));
}

// Sixteen grey levels from (x, y) on; those beyond the picture are nothing, and its memory is not touched.
template <typename Grey>
const Grey* sixteen(const ImageView<Grey>& picture, int x, int y, Grey (&edge)[kBlockWidth]) {
  const Grey* const at = picture.row(y).data() + x;
  if (x + kBlockWidth <= picture.width) return at;
  std::fill_n(edge, kBlockWidth, Grey{0});
  std::copy_n(at, picture.width - x, edge);
  return edge;
}

// Rows lie kilobytes apart: no processor foresees where the next one begins.
constexpr int kRowsAhead = 4;
template <typename Grey>
HWY_INLINE void fetch(const ImageView<Grey>& picture, const PixelBox& box, int y) {
  if (y > box.y1) return;
  constexpr int kLine = 64 / static_cast<int>(sizeof(Grey));
  const Grey* const row = picture.row(y).data();
  for (int x = box.x0; x <= box.x1 + kLine - 1; x += kLine) hwy::Prefetch(row + std::min(x, box.x1));
}

template <Sum kSum, typename Grey>
int add_band(const PatchJob& job, const Patch& patch, const ImageView<Grey>& picture, int first, int last,
             LaneSums& lanes) {
  const Float d;
  const V step = hn::Set(d, float{kBlockWidth});
  Grey edge[kBlockWidth];
  int pixels = 0;
  for (int lane = 0; lane < kBlockWidth; lane += kLanes) {
    Registers<kSum> sums;
    for (int k = 0; k < registers_of(kSum); ++k) sums[k] = hn::Zero(d);
    for (int y = first; y <= last; y += job.row_step) {
      const Row row(job, static_cast<float>(y - job.y));
      if (lane == 0) fetch(picture, job.box, y + kRowsAhead * job.row_step);
      V dx = hn::Iota(d, static_cast<float>(job.box.x0 - job.x + lane));
      V left = hn::Sub(hn::Set(d, static_cast<float>(job.box.x1 - job.x)), dx);
      for (int x = job.box.x0; x <= job.box.x1; x += kBlockWidth) {
        const V grey = greys(sixteen(picture, x, y, edge) + lane);
        pixels += add_block<kSum>(patch, row, grey, dx, hn::Ge(left, hn::Zero(d)), lane, lanes, sums);
        dx = hn::Add(dx, step), left = hn::Sub(left, step);
      }
    }
    for (int k = 0; k < registers_of(kSum); ++k) hn::Store(sums[k], d, lanes.right[k] + lane);
  }
  return pixels;
}

template <Sum kSum, typename Grey>
void pass(const PatchJob& job, const ImageView<Grey>& picture, PatchTotals& out) {
  LaneSums lanes;
  const Patch patch(job);
  const int band = kBandRows * job.row_step;
  for (int y = job.box.y0; y <= job.box.y1; y += band) {
    if constexpr (kSum == Sum::kNormal) std::fill_n(&lanes.normal[0][0], kProducts * kBlockWidth, 0.0F);
    out.pixels += add_band<kSum>(job, patch, picture, y, std::min(y + band - 1, job.box.y1), lanes);
    for (int k = 0; k < registers_of(kSum); ++k) out.sums[static_cast<std::size_t>(k)] += folded(lanes.right[k]);
    if constexpr (kSum == Sum::kNormal) {
      for (int i = 0, k = 0; i < kColumns; ++i) {
        for (int j = 0; j <= i; ++j, ++k) (*out.normal)(i, j) += folded(lanes.normal[k]);
      }
    }
  }
}

template <typename Grey>
void pass_of(const PatchJob& job, const ImageView<Grey>& picture, Sum sum, PatchTotals& out) {
  switch (sum) {
    case Sum::kRight: return pass<Sum::kRight>(job, picture, out);
    case Sum::kNormal: return pass<Sum::kNormal>(job, picture, out);
    case Sum::kShift: return pass<Sum::kShift>(job, picture, out);
  }
}

void Pass8(const PatchJob& job, const ImageView<std::uint8_t>& p, Sum sum, PatchTotals& out) { pass_of(job, p, sum, out); }
void Pass16(const PatchJob& job, const ImageView<std::uint16_t>& p, Sum sum, PatchTotals& out) { pass_of(job, p, sum, out); }

}  // namespace HWY_NAMESPACE
}  // namespace moiregauge
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace moiregauge {
namespace {

std::array<float, 3> in_floats(const PatchPlane& p) {
  return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
}

PatchJob job_of(const PatchModel& model, const PrintNodes& nodes, const PixelBox& box, int row_step) {
  PatchJob job;
  job.x = (box.x0 + box.x1) / 2, job.y = (box.y0 + box.y1) / 2;
  const PatchWindow& w = model.window;
  Matrix3 from_middle;
  from_middle << 1, 0, job.x, 0, 1, job.y, 0, 0, 1;
  const Matrix3 h = window_from_print(w).matrix() * model.map.matrix() * from_middle;
  for (int i = 0; i < 9; ++i) job.uv_from_px[static_cast<std::size_t>(i)] = static_cast<float>(h(i / 3, i % 3) / h(2, 2));
  job.light = in_floats(model.light), job.contrast = in_floats(model.contrast), job.gain = in_floats(model.gain);
  const double side = nodes.side;
  job.nodes = {static_cast<float>(side * w.centre.x), static_cast<float>(side * w.half_x),
               static_cast<float>(side * w.centre.y), static_cast<float>(side * w.half_y)};
  job.table = &nodes;
  job.box = box;
  job.row_step = row_step;
  return job;
}

}  // namespace

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

void sum_patch(const LumaView& luma, const PatchModel& model, const PrintNodes& nodes, const PixelBox& box, int row_step,
               PatchSums& sums, NormalMatrix* normal) {
  PatchTotals totals;
  totals.normal = normal;
  if (normal != nullptr) normal->setZero();
  dispatched(luma, job_of(model, nodes, box, row_step), normal == nullptr ? Sum::kRight : Sum::kNormal, totals);
  sums.right = Eigen::Map<const NormalVector>(totals.sums.data());
  sums.left2 = totals.sums[kColumns];
  sums.pixels = totals.pixels;
  if (normal != nullptr) *normal = NormalMatrix(normal->selfadjointView<Eigen::Lower>());
}

void sum_shift(const LumaView& luma, const PatchModel& model, const PrintNodes& nodes, const PixelBox& box, int row_step,
               ShiftSums& sums) {
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

}  // namespace moiregauge
#endif
