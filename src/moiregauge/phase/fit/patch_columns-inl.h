// SPDX-License-Identifier: Apache-2.0
// Prediction and columns of a vector of pixels, and sums of lanes. patch_pass.cc includes this file once for every SIMD
// target.
#if defined(MOIREGAUGE_PATCH_COLUMNS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MOIREGAUGE_PATCH_COLUMNS_INL_H
#undef MOIREGAUGE_PATCH_COLUMNS_INL_H
#else
#define MOIREGAUGE_PATCH_COLUMNS_INL_H
#endif

#include <hwy/highway.h>

#include "moiregauge/image/lane_steps.h"
#include "moiregauge/phase/fit/patch_job.h"

HWY_BEFORE_NAMESPACE();
namespace moiregauge::internal {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Float = hn::CappedTag<float, kBlockWidth>;
using Whole = hn::RebindToSigned<Float>;
using V = hn::Vec<Float>;
constexpr int kLanes = static_cast<int>(hn::MaxLanes(Float()));
using LaneRow = float[kBlockWidth];

// Returns a + b c. MulAdd would round once on some targets and twice on others.
HWY_INLINE V plus(V a, V b, V c) { return hn::Add(a, hn::Mul(b, c)); }

// Returns first, first + 1, ... .
HWY_INLINE V lanes_from(int first) {
  return hn::Add(hn::Load(Float(), kLaneSteps<float>), hn::Set(Float(), static_cast<float>(first)));
}

struct Plane {
  V at_0, per_u, per_v;
  explicit Plane(const std::array<float, 3>& c)
      : at_0(hn::Set(Float(), c[0])), per_u(hn::Set(Float(), c[1])), per_v(hn::Set(Float(), c[2])) {}
  HWY_INLINE V operator()(V u, V v) const { return plus(plus(at_0, per_u, u), per_v, v); }
};

struct Level {
  V t, tx, ty, bx, by;  // level and derivatives per distance of nodes
  V edge;               // tx^2 + ty^2
};

// Distances from the nearest node, nodes.
struct FromNode {
  V x, y;
};

// Evaluates the table of nodes as PrintTemplate::at does.
struct Table {
  const std::int32_t* words;
  V side, per_side, wide, words_per_node;
  V scale[2 * PrintNodes::kWords];

  // The table begins one node before the period along both axes.
  explicit Table(const PrintNodes& nodes) : words(nodes.words.data() + (nodes.wide() + 1) * PrintNodes::kStride) {
    const auto set = [](auto value) { return hn::Set(Float(), static_cast<float>(value)); };
    side = set(nodes.side), per_side = set(1.0F / static_cast<float>(nodes.side)), wide = set(nodes.wide());
    words_per_node = set(PrintNodes::kStride);
    for (int k = 0; k < 2 * PrintNodes::kWords; ++k) scale[k] = set(nodes.scale[static_cast<std::size_t>(k)]);
  }

#if HWY_TARGET == HWY_SCALAR
  // Reads the words of the only lane's node.
  HWY_INLINE void nodes_of(const std::int32_t* at_node, hn::Vec<Whole> (&out)[PrintNodes::kWords]) const {
    for (int w = 0; w < PrintNodes::kWords; ++w) out[w] = hn::Set(Whole(), words[at_node[0] + w]);
  }
#else
  // Returns the four words of every fourth node from the first, each in a block of four lanes.
  template <class D>
  HWY_INLINE hn::Vec<D> every_fourth(D d, const std::int32_t* at_node) const {
    if constexpr (hn::MaxLanes(D()) <= 4) {
      return hn::LoadU(d, words + at_node[0]);
    } else {
      const hn::Half<D> half;
      constexpr int kNodes = static_cast<int>(hn::MaxLanes(D())) / 2;
      return hn::Combine(d, every_fourth(half, at_node + kNodes), every_fourth(half, at_node));
    }
  }

  // Reads the words of each lane's node. Whole nodes are loaded and transposed, because a gather costs more.
  HWY_INLINE void nodes_of(const std::int32_t* at_node, hn::Vec<Whole> (&out)[PrintNodes::kWords]) const {
    const Whole d;
    const hn::RepartitionToWide<Whole> pairs;
    const auto r0 = every_fourth(d, at_node), r1 = every_fourth(d, at_node + 1), r2 = every_fourth(d, at_node + 2),
               r3 = every_fourth(d, at_node + 3);
    const auto low_01 = hn::BitCast(pairs, hn::InterleaveLower(d, r0, r1));
    const auto low_23 = hn::BitCast(pairs, hn::InterleaveLower(d, r2, r3));
    const auto high_01 = hn::BitCast(pairs, hn::InterleaveUpper(d, r0, r1));
    const auto high_23 = hn::BitCast(pairs, hn::InterleaveUpper(d, r2, r3));
    out[0] = hn::BitCast(d, hn::InterleaveLower(pairs, low_01, low_23));
    out[1] = hn::BitCast(d, hn::InterleaveUpper(pairs, low_01, low_23));
    out[2] = hn::BitCast(d, hn::InterleaveLower(pairs, high_01, high_23));
  }
#endif

  // Returns the node's index in the period.
  HWY_INLINE V node_of(V whole) const { return hn::Sub(whole, hn::Mul(side, hn::Floor(hn::Mul(whole, per_side)))); }

  // Stores each lane's node, as an index of `words`, and returns the position relative to it.
  HWY_INLINE FromNode find(V x, V y, std::int32_t* at_node) const {
    const Whole di;
    const V i = hn::Round(x), j = hn::Round(y);
    hn::Store(hn::ConvertTo(di, hn::Mul(plus(node_of(i), node_of(j), wide), words_per_node)), di, at_node);
    return {hn::Sub(x, i), hn::Sub(y, j)};
  }

  HWY_INLINE Level at(const std::int32_t* at_node, const FromNode& from) const {
    const Float d;
    const V u = from.x, v = from.y;
    hn::Vec<Whole> words_of[PrintNodes::kWords];
    nodes_of(at_node, words_of);
    V a[2 * PrintNodes::kWords];
#pragma GCC unroll 3
    for (int w = 0; w < PrintNodes::kWords; ++w) {
      a[2 * w] = hn::Mul(hn::ConvertTo(d, hn::ShiftRight<16>(hn::ShiftLeft<16>(words_of[w]))), scale[2 * w]);
      a[2 * w + 1] = hn::Mul(hn::ConvertTo(d, hn::ShiftRight<16>(words_of[w])), scale[2 * w + 1]);
    }
    const V bx = hn::Add(a[3], a[3]), by = hn::Add(a[5], a[5]);
    const V tx = plus(plus(a[1], u, bx), v, a[4]), ty = plus(plus(a[2], v, by), u, a[4]);
    const V half = hn::Set(d, 0.5F);  // u (a1 + tx) + v (a2 + ty) is twice the rest of the Taylor series
    const V t = plus(a[0], half, plus(hn::Mul(u, hn::Add(a[1], tx)), v, hn::Add(a[2], ty)));
    return {t, tx, ty, bx, by, plus(hn::Mul(tx, tx), ty, ty)};
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

// Calls `put` with each column times `one`. The level contains this factor already.
template <typename Put>
HWY_INLINE void expand(V one, const Level& l, V u, V v, const Put& put) {
  put(0, one), put(1, hn::Mul(one, u)), put(2, hn::Mul(one, v));
  put(3, l.t), put(4, hn::Mul(l.t, u)), put(5, hn::Mul(l.t, v));
  put(6, l.bx), put(7, l.by), put(8, l.edge);
  expand_field<kBaseColumns>(l.tx, u, v, put);
  expand_field<kBaseColumns + kFieldColumns>(l.ty, u, v, put);
}

HWY_INLINE Level times(const Level& l, V f) {
  return {hn::Mul(l.t, f), hn::Mul(l.tx, f), hn::Mul(l.ty, f), hn::Mul(l.bx, f), hn::Mul(l.by, f), hn::Mul(l.edge, f)};
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
    side = table.side, one = set(1);
    const float side2 = static_cast<float>(job.table->side) * static_cast<float>(job.table->side);
    blur_x = set(side2 * job.shape[0]), blur_y = set(side2 * job.shape[1]), width = set(side2 * job.shape[2]);
    has_shape = job.shape != std::array<float, 3>{};
    x0 = set(job.nodes[0]), half_x = set(job.nodes[1]), y0 = set(job.nodes[2]), half_y = set(job.nodes[3]);
    row_x = set(job.uv_from_px[0]), row_y = set(job.uv_from_px[3]), row_z = set(job.uv_from_px[6]);
  }

  // Returns the predicted grey level at (u, v). `l`: level per distance of nodes. `factor`: gain there.
  HWY_INLINE V shown(V u, V v, const Level& l, V factor) const {
    const V flat = plus(light(u, v), contrast(u, v), l.t);
    if (!has_shape) return flat;
    return plus(flat, factor, plus(plus(hn::Mul(blur_x, l.bx), blur_y, l.by), width, l.edge));
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

// Positions of a vector of pixels in the window.
struct Positions {
  V u, v, per_z;
  HWY_INLINE Positions(const Patch& patch, const Row& row, V dx) {
    per_z = hn::Div(patch.one, plus(row.z, patch.row_z, dx));
    u = hn::Mul(plus(row.x, patch.row_x, dx), per_z), v = hn::Mul(plus(row.y, patch.row_y, dx), per_z);
  }
};

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

HWY_INLINE void add_to(float* sums, V value) {
  const Float d;
  hn::Store(hn::Add(hn::Load(d, sums), value), d, sums);
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

}  // namespace HWY_NAMESPACE
}  // namespace moiregauge::internal
HWY_AFTER_NAMESPACE();

#endif
