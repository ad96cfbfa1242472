// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/phase/patch_pass.h"

#include <algorithm>
#include <variant>

#define HWY_COMPILE_ALL_ATTAINABLE  // the scalar one too: it is what the others are compared with
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "moiregauge/phase/patch_pass.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "moiregauge/phase/patch_rows.h"

HWY_BEFORE_NAMESPACE();
namespace moiregauge {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Float = hn::CappedTag<float, kBlockWidth>;
using Whole = hn::RebindToSigned<Float>;
using V = hn::Vec<Float>;
constexpr int kLanes = static_cast<int>(hn::MaxLanes(Float()));
// Rows of a block share their v: never more of them than a fourteenth of half the patch.
constexpr int kMostRows = 4;
constexpr double kRowsShare = 1.0 / 14.0;
// Highest power of u, and of v, that each product is needed with.
constexpr std::array<int, kPatchProducts> kHighest{4, 4, 4, 3, 3, 3, 3, 2, 2, 2, 2, 2, 1, 1,
                                                   0, 2, 2, 2, 2, 1, 1, 1, 1, 0, 0, 0, 0, 0};

struct Nodes {
  const std::int32_t* words;
  V side, one_over_side, wide, words_per_node;
  V scale[2 * PrintNodes::kWords];
};

struct Level {
  V t, tx, ty, bx, by;
};

HWY_INLINE V plus(V a, V b, V c) { return hn::Add(a, hn::Mul(b, c)); }  // not MulAdd: it rounds once where it can

HWY_INLINE V wrapped(const Nodes& n, V whole) {
  return hn::Sub(whole, hn::Mul(n.side, hn::Floor(hn::Mul(whole, n.one_over_side))));
}

// PrintTemplate::at, its slopes by nodes.
HWY_INLINE Level level_at(const Nodes& n, V x, V y) {
  const Whole di;
  const Float d;
  const V i = hn::Round(x), j = hn::Round(y), u = hn::Sub(x, i), v = hn::Sub(y, j), one = hn::Set(d, 1.0F);
  const V node = hn::Add(hn::Mul(hn::Add(wrapped(n, j), one), n.wide), hn::Add(wrapped(n, i), one));
  const auto at = hn::ConvertTo(di, hn::Mul(node, n.words_per_node));
  V a[2 * PrintNodes::kWords];
  for (int w = 0; w < PrintNodes::kWords; ++w) {
    const auto word = hn::GatherIndex(di, n.words + w, at);
    a[2 * w] = hn::Mul(hn::ConvertTo(d, hn::ShiftRight<16>(hn::ShiftLeft<16>(word))), n.scale[2 * w]);
    a[2 * w + 1] = hn::Mul(hn::ConvertTo(d, hn::ShiftRight<16>(word)), n.scale[2 * w + 1]);
  }
  const V two = hn::Set(d, 2.0F), u2 = hn::Mul(two, u), v2 = hn::Mul(two, v), u3 = hn::Mul(hn::Set(d, 3.0F), u),
          v3 = hn::Mul(hn::Set(d, 3.0F), v);
  Level l;
  l.t = plus(plus(a[0], u, plus(a[1], u, plus(a[3], u, a[6]))), v,
             plus(plus(a[2], u, plus(a[4], u, a[7])), v, plus(plus(a[5], u, a[8]), v, a[9])));
  l.tx = plus(plus(a[1], u, plus(hn::Mul(two, a[3]), u3, a[6])), v, plus(plus(a[4], u2, a[7]), v, a[8]));
  l.ty = plus(plus(a[2], v, plus(hn::Mul(two, a[5]), v3, a[9])), u, plus(plus(a[4], v2, a[8]), u, a[7]));
  l.bx = hn::Mul(two, plus(plus(a[3], u3, a[6]), v, a[7]));
  l.by = hn::Mul(two, plus(plus(a[5], v3, a[9]), u, a[8]));
  return l;
}

HWY_INLINE V greys(const std::uint8_t* from) {
  const hn::Rebind<std::uint8_t, Float> d8;
  return hn::ConvertTo(Float(), hn::PromoteTo(Whole(), hn::LoadU(d8, from)));
}
HWY_INLINE V greys(const std::uint16_t* from) {
  const hn::Rebind<std::uint16_t, Float> d16;
  return hn::ConvertTo(Float(), hn::PromoteTo(Whole(), hn::LoadU(d16, from)));
}

HWY_INLINE void add(V (&sum)[kPatchProducts], const Level& l, V g, V one) {
  const V tx = l.tx, ty = l.ty, t = l.t, bx = l.bx, by = l.by;
  const V product[kPatchProducts] = {
      hn::Mul(tx, tx), hn::Mul(tx, ty), hn::Mul(ty, ty), tx,              ty,              hn::Mul(t, tx),  hn::Mul(t, ty),
      hn::Mul(g, tx),  hn::Mul(g, ty),  one,             t,               hn::Mul(t, t),   g,               hn::Mul(g, t),
      hn::Mul(g, g),   hn::Mul(bx, tx), hn::Mul(bx, ty), hn::Mul(by, tx), hn::Mul(by, ty), bx,              by,
      hn::Mul(t, bx),  hn::Mul(t, by),  hn::Mul(g, bx),  hn::Mul(g, by),  hn::Mul(bx, bx), hn::Mul(bx, by), hn::Mul(by, by)};
  for (int f = 0; f < kPatchProducts; ++f) sum[f] = hn::Add(sum[f], product[f]);
}

struct Window {
  V x, y, half_x, half_y;
};

// Sixteen lanes of every product times every power of u that it is needed with.
struct LaneSums {
  alignas(64) float of[kPatchProducts][kPatchPowers][kBlockWidth];
};

struct Block {
  const RowMap* rows;
  int count;    // of rows
  int last;     // of the lanes that lie in the box
  float u, per_px;  // of the block's middle, and from lane to lane
};

template <typename Grey>
HWY_INLINE void sum_lanes(const Nodes& nodes, const Window& window, const Block& block, const Grey* const* grey,
                          float side, int lane, LaneSums& lanes) {
  const Float d;
  V sum[kPatchProducts];
  for (V& s : sum) s = hn::Zero(d);
  const V k = hn::Add(hn::Iota(d, static_cast<float>(lane)), hn::Set(d, -0.5F * (kBlockWidth - 1)));
  const auto there = hn::Le(hn::Iota(d, static_cast<float>(lane)), hn::Set(d, static_cast<float>(block.last)));
  for (int r = 0; r < block.count; ++r) {
    const RowMap& m = block.rows[r];
    const auto line = [&](const std::array<float, 2>& c) { return plus(hn::Set(d, c[0]), k, hn::Set(d, c[1])); };
    const V x = plus(hn::Set(d, m.x[0]), k, plus(hn::Set(d, m.x[1]), k, hn::Set(d, m.x[2])));
    const V y = plus(hn::Set(d, m.y[0]), k, plus(hn::Set(d, m.y[1]), k, hn::Set(d, m.y[2])));
    const auto in = hn::And(there, hn::And(hn::Le(hn::Abs(hn::Sub(x, window.x)), window.half_x),
                                           hn::Le(hn::Abs(hn::Sub(y, window.y)), window.half_y)));
    if (hn::AllFalse(d, in)) continue;
    Level l = level_at(nodes, x, y);
    const V gain = hn::IfThenElseZero(in, line(m.gain)), bend = hn::Mul(gain, hn::Set(d, side));
    l.t = hn::IfThenElseZero(in, l.t);
    l.tx = hn::Mul(gain, l.tx);
    l.ty = hn::Mul(gain, l.ty);
    l.bx = hn::Mul(bend, l.bx);
    l.by = hn::Mul(bend, l.by);
    const V left = hn::Sub(hn::Sub(greys(grey[r] + lane), line(m.light)), hn::Mul(line(m.contrast), l.t));
    add(sum, l, hn::IfThenElseZero(in, left), hn::IfThenElseZero(in, hn::Set(d, 1.0F)));
  }
  const V u = plus(hn::Set(d, block.u), k, hn::Set(d, block.per_px));
  for (int f = 0; f < kPatchProducts; ++f) {
    for (int p = 0; p <= kHighest[static_cast<std::size_t>(f)]; ++p) {
      float* const to = lanes.of[f][p] + lane;
      hn::Store(hn::Add(hn::Load(d, to), sum[f]), d, to);
      sum[f] = hn::Mul(sum[f], u);
    }
  }
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

Nodes nodes_of(const PrintNodes& table) {
  const Float d;
  const auto side = static_cast<float>(table.side);
  Nodes nodes{table.words.data(), hn::Set(d, side), hn::Set(d, 1.0F / side), hn::Set(d, static_cast<float>(table.wide())),
              hn::Set(d, static_cast<float>(PrintNodes::kWords)), {}};
  for (int k = 0; k < 2 * PrintNodes::kWords; ++k) nodes.scale[k] = hn::Set(d, table.scale[static_cast<std::size_t>(k)]);
  return nodes;
}

Window window_of(const PatchWindow& w, float side) {
  const auto in_nodes = [side](double pitches) { return hn::Set(Float(), static_cast<float>(pitches) * side); };
  return {in_nodes(w.centre.x), in_nodes(w.centre.y), in_nodes(w.half_x), in_nodes(w.half_y)};
}

// Lanes folded, rows given the powers of their v.
void add_rows(LaneSums& lanes, double v, PatchSums& out) {
  for (int f = 0; f < kPatchProducts; ++f) {
    const int highest = kHighest[static_cast<std::size_t>(f)];
    for (int k = 0; k <= highest; ++k) {
      double value = folded(lanes.of[f][k]);
      for (int l = 0; l <= highest; ++l, value *= v) out.at(f, k, l) += value;
    }
  }
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

template <typename Grey>
void Pass(const PatchJob& job, const ImageView<Grey>& picture, PatchSums& out) {
  const Nodes nodes = nodes_of(*job.nodes);
  const auto side = static_cast<float>(job.nodes->side);
  const Window window = window_of(job.window, side);
  const PatchMap& map = job.map;
  const PixelBox& box = job.box;
  const int most = std::clamp(static_cast<int>(map.scale * kRowsShare) / job.row_step, 1, kMostRows);
  const auto per_px = static_cast<float>(1.0 / map.scale);
  LaneSums lanes;
  Grey edge[kMostRows][kBlockWidth];
  for (int y = box.y0; y <= box.y1; y += most * job.row_step) {
    const int count = std::min(most, (box.y1 - y) / job.row_step + 1);
    RowField fields[kMostRows];
    for (int r = 0; r < count; ++r) fields[r] = field_on(map, (y + r * job.row_step - map.y0) / map.scale);
    std::fill_n(&lanes.of[0][0][0], sizeof lanes.of / sizeof(float), 0.0F);
    for (int x = box.x0; x <= box.x1; x += kBlockWidth) {
      const double middle = x + 0.5 * (kBlockWidth - 1);
      RowMap rows[kMostRows];
      const Grey* grey[kMostRows];
      for (int r = 0; r < count; ++r) {
        const int row = y + r * job.row_step;
        rows[r] = row_map(job, fields[r], middle, row);
        grey[r] = sixteen(picture, x, row, edge[r]);
      }
      const Block block{rows, count, box.x1 - x, static_cast<float>((middle - map.x0) / map.scale), per_px};
      for (int lane = 0; lane < kBlockWidth; lane += kLanes)
        sum_lanes(nodes, window, block, grey, side, lane, lanes);
    }
    add_rows(lanes, (y + 0.5 * (count - 1) * job.row_step - map.y0) / map.scale, out);
  }
}

void Pass8(const PatchJob& job, const ImageView<std::uint8_t>& picture, PatchSums& out) { Pass(job, picture, out); }
void Pass16(const PatchJob& job, const ImageView<std::uint16_t>& picture, PatchSums& out) { Pass(job, picture, out); }

}  // namespace HWY_NAMESPACE
}  // namespace moiregauge
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace moiregauge {

HWY_EXPORT(Pass8);
HWY_EXPORT(Pass16);

void sum_patch(const LumaView& luma, const PatchMap& map, const PatchWindow& window, const PrintNodes& nodes,
               const PixelBox& box, int row_step, PatchSums& sums) {
  const PatchJob job{map, map.map.matrix(), window, &nodes, box, row_step};
  sums.total.fill(0.0);
  if (const auto* view = std::get_if<ImageView<std::uint8_t>>(&luma))
    HWY_DYNAMIC_DISPATCH(Pass8)(job, *view, sums);
  else
    HWY_DYNAMIC_DISPATCH(Pass16)(job, *std::get_if<ImageView<std::uint16_t>>(&luma), sums);
}

}  // namespace moiregauge
#endif
