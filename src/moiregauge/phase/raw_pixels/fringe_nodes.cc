// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/phase/raw_pixels/fringe_nodes.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <variant>

#include "moiregauge/image/fetch_row.h"
#include "moiregauge/image/lane_steps.h"
#include "moiregauge/image/simd_options.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "moiregauge/phase/raw_pixels/fringe_nodes.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef MOIREGAUGE_FRINGE_JOB
#define MOIREGAUGE_FRINGE_JOB
namespace moiregauge::internal {
namespace {

constexpr int kStripWidth = 16;
// Real part and minus the imaginary part of the fringe along X, then of that along Y.
constexpr int kParts = 4;
// Map in single precision. Pixels count from the box's middle one, so that the numbers suit it.
struct FringeJob {
  std::array<float, 9> from_px{};  // homography, row by row, with last element 1
  int x = 0, y = 0;                // middle pixel, px
  float background = 0.0F, per_half = 1.0F;
  bool is_bent = false;
  std::array<std::array<float, 9>, 2> bend{};
  PixelBox box;
  int nodes = 1;
  float cell = 1.0F, low = 0.0F, window = 1.0F;  // periods: side of a cell, first edge of the region, half the window
  // A quarter of a pixel, in periods along X and Y. A window is the mean of its values this far to both sides. This removes the part of
  // its spectrum that pixels would fold onto the carrier.
  std::array<float, 2> quarter_px{};
};

// Sixteen lanes of every sum.
struct FringeLanes {
  alignas(64) float sums[kMaxNodes * kMaxNodes][kParts][kStripWidth];
};

}  // namespace
}  // namespace moiregauge::internal
#endif

HWY_BEFORE_NAMESPACE();
namespace moiregauge::internal {
// Vectors are parameters of their own, because some targets do not allow them in structs.
// NOLINTBEGIN(readability-function-size)
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Float = hn::CappedTag<float, kStripWidth>;
using V = hn::Vec<Float>;
constexpr int kStripLanes = static_cast<int>(hn::MaxLanes(Float()));

// Returns a + b c. MulAdd would round once on some targets and twice on others.
HWY_INLINE V plus(V a, V b, V c) { return hn::Add(a, hn::Mul(b, c)); }

HWY_INLINE V all(float value) { return hn::Set(Float(), value); }

template <typename Grey>
HWY_INLINE V greys(const Grey* from) {
  const hn::Rebind<Grey, Float> d;
  const hn::RebindToSigned<Float> whole;
  return hn::ConvertTo(Float(), hn::PromoteTo(whole, hn::LoadU(d, from)));
}

// Returns the polynomial c0 + c1 y + ... .
template <std::size_t kCount>
HWY_INLINE V polynomial(const float (&c)[kCount], V y) {
  V sum = all(c[kCount - 1]);
  for (std::size_t k = kCount - 1; k-- > 0;) sum = plus(all(c[k]), sum, y);
  return sum;
}

// Cosine and sine of 2 pi X.
struct Carrier {
  V cosine, sine;
  // Taylor series of sin(pi x) / x and cos(pi x) in x^2, |x| <= 1/2. The first neglected terms are 6e-8 and 7e-9.
  HWY_INLINE explicit Carrier(V periods) {
    const V x = hn::Sub(periods, hn::Round(periods)), y = hn::Mul(x, x);
    const V s = hn::Mul(
        x, polynomial({3.14159265F, -5.16771278F, 2.55016404F, -0.599264529F, 0.0821458866F, -0.00737043095F}, y));
    const V c =
        polynomial({1.0F, -4.93480220F, 4.05871213F, -1.33526277F, 0.235330630F, -0.0258068913F, 0.00192957431F}, y);
    const V twice = hn::Add(s, s);
    cosine = hn::Sub(all(1.0F), hn::Mul(twice, s)), sine = hn::Mul(twice, c);
  }
};

HWY_INLINE V biquadratic(const std::array<float, 9>& c, V x, V y) {
  const auto row = [&](std::size_t j) { return plus(all(c[3 * j]), plus(all(c[3 * j + 1]), all(c[3 * j + 2]), x), x); };
  return plus(row(0), plus(row(1), row(2), y), y);
}

// Sixteen columns of pixels, whose grating coordinates share their terms in x.
struct Strip {
  V along_x, along_y, along_z;
  HWY_INLINE Strip(const FringeJob& job, V dx)
      : along_x(hn::Mul(all(job.from_px[0]), dx)),
        along_y(hn::Mul(all(job.from_px[3]), dx)),
        along_z(hn::Mul(all(job.from_px[6]), dx)) {}
};

// Position in the grating, and area of a pixel relative to that of the middle one.
struct Position {
  V x, y, area;
  template <bool kIsBent>
  HWY_INLINE static Position of(const FringeJob& job, const Strip& strip, float dy) {
    const auto& h = job.from_px;
    const V z = hn::Div(all(1.0F), hn::Add(strip.along_z, all(h[8] + h[7] * dy)));
    Position p{hn::Mul(hn::Add(strip.along_x, all(h[2] + h[1] * dy)), z),
               hn::Mul(hn::Add(strip.along_y, all(h[5] + h[4] * dy)), z), hn::Mul(z, hn::Mul(z, z))};
    if constexpr (kIsBent) {
      const V u = hn::Mul(p.x, all(job.per_half)), v = hn::Mul(p.y, all(job.per_half));
      p.x = hn::Add(p.x, biquadratic(job.bend[0], u, v)), p.y = hn::Add(p.y, biquadratic(job.bend[1], u, v));
    }
    return p;
  }
};

// Cells whose windows contain a position, along one axis. None if last < first.
struct Cells {
  int first = kMaxNodes, last = -1;

  void include(const Cells& other) { first = std::min(first, other.first), last = std::max(last, other.last); }
};

// `in`: lanes inside the window, at least one. No other lane counts.
template <typename Mask>
HWY_INLINE Cells cells_at(const FringeJob& job, float quarter_px, V at, Mask in) {
  const Float d;
  const float low = hn::GetLane(hn::MinOfLanes(d, hn::IfThenElse(in, at, all(job.window))));
  const float high = hn::GetLane(hn::MaxOfLanes(d, hn::IfThenElse(in, at, all(-job.window))));
  const float reach = 1.0F + quarter_px;
  return {std::max(0, static_cast<int>((low - reach - job.low) / job.cell)),
          std::min(job.nodes - 1, static_cast<int>((high + reach - job.low) / job.cell))};
}

// Weights of a position in the windows of cells. A window is the integral of the triangle of Eq. (2) over its cell.
struct CellWeights {
  V weight[kMaxNodes];

  HWY_INLINE CellWeights(const FringeJob& job, float quarter_px, V at, const Cells& cells) {
    const V below = hn::Sub(at, all(quarter_px)), above = hn::Add(at, all(quarter_px));
    const auto steps = [&](int k) {
      const V edge = all(job.low + static_cast<float>(k) * job.cell);
      return hn::Add(step(hn::Sub(below, edge)), step(hn::Sub(above, edge)));
    };
    V before = steps(cells.first);
    for (int k = cells.first; k <= cells.last; ++k) {
      const V after = steps(k + 1);
      weight[k] = hn::Sub(before, after);
      before = after;
    }
  }
  // Returns the triangle's integral from 0 to t.
  HWY_INLINE static V step(V t) {
    const V a = hn::Min(hn::Max(t, all(-1.0F)), all(1.0F));
    return hn::Mul(a, hn::Sub(all(1.0F), hn::Mul(all(0.5F), hn::Abs(a))));
  }
};

// Pixels of one row of a strip: their positions and demodulated grey levels, zero outside the window.
struct FringeRow {
  V x, y, parts[kParts];
  Cells along, across;

  HWY_INLINE FringeRow() : x(hn::Zero(Float())), y(x), parts{x, x, x, x} {}

  template <bool kIsBent, typename Grey>
  HWY_INLINE void read(const FringeJob& job, const Strip& strip, V dx, const Grey* from, float dy) {
    const Float d;
    const Position at = Position::of<kIsBent>(job, strip, dy);
    const auto in = hn::And(hn::Lt(hn::Max(hn::Abs(at.x), hn::Abs(at.y)), all(job.window)),
                            hn::Le(dx, all(static_cast<float>(job.box.x1 - job.x))));
    if (hn::AllFalse(d, in)) return;
    along = cells_at(job, job.quarter_px[0], at.x, in), across = cells_at(job, job.quarter_px[1], at.y, in);
    x = hn::IfThenElseZero(in, at.x), y = hn::IfThenElseZero(in, at.y);
    const V grey = hn::Sub(greys(from), all(job.background));
    const V part = hn::IfThenElseZero(in, hn::Mul(grey, at.area));
    const Carrier of_x(x), of_y(y);
    parts[0] = hn::Mul(part, of_x.cosine), parts[1] = hn::Mul(part, of_x.sine);
    parts[2] = hn::Mul(part, of_y.cosine), parts[3] = hn::Mul(part, of_y.sine);
  }
};

// Adds two rows at once, because a sum costs more to load and store than to compute.
HWY_INLINE void add_rows(const FringeJob& job, const FringeRow& upper, const FringeRow& lower, int lane,
                         FringeLanes& lanes) {
  const Float d;
  Cells across = upper.across, along = upper.along;
  across.include(lower.across), along.include(lower.along);
  if (across.last < across.first) return;
  const CellWeights upper_y(job, job.quarter_px[1], upper.y, across), lower_y(job, job.quarter_px[1], lower.y, across);
  const CellWeights upper_x(job, job.quarter_px[0], upper.x, along), lower_x(job, job.quarter_px[0], lower.x, along);
  for (int l = across.first; l <= across.last; ++l) {
    for (int k = along.first; k <= along.last; ++k) {
      const V u = hn::Mul(upper_y.weight[l], upper_x.weight[k]), v = hn::Mul(lower_y.weight[l], lower_x.weight[k]);
      auto& to = lanes.sums[l * job.nodes + k];
      for (int s = 0; s < kParts; ++s) {
        const V sum = plus(plus(hn::Load(d, to[s] + lane), u, upper.parts[s]), v, lower.parts[s]);
        hn::Store(sum, d, to[s] + lane);
      }
    }
  }
}

// Adds rows y and y + 1 of the strip from x on.
template <typename Grey, bool kIsBent>
HWY_INLINE void add_strip(const FringeJob& job, const ImageView<Grey>& picture, int x, int y, int lane,
                          FringeLanes& lanes) {
  const V dx = hn::Add(hn::Load(Float(), kLaneSteps<float>), all(static_cast<float>(x - job.x + lane)));
  const Strip strip(job, dx);
  Grey edge[kStripWidth];
  const float dy = static_cast<float>(y - job.y);
  FringeRow upper, lower;
  upper.read<kIsBent>(job, strip, dx, pixels_from(picture, x, y, edge) + lane, dy);
  if (y < job.box.y1) lower.read<kIsBent>(job, strip, dx, pixels_from(picture, x, y + 1, edge) + lane, dy + 1.0F);
  add_rows(job, upper, lower, lane, lanes);
}

// Rows by which memory is fetched ahead. Chosen.
constexpr int kFringeAhead = 8;

template <typename Grey, bool kIsBent>
void add_strips(const FringeJob& job, const ImageView<Grey>& picture, FringeLanes& lanes) {
  for (int y = job.box.y0; y <= job.box.y1; y += 2) {
    for (int k = y + kFringeAhead; k < y + kFringeAhead + 2 && k <= job.box.y1; ++k)
      fetch_row(picture, k, job.box.x0, job.box.x1);
    for (int x = job.box.x0; x <= job.box.x1; x += kStripWidth) {
      for (int lane = 0; lane < kStripWidth; lane += kStripLanes)
        add_strip<Grey, kIsBent>(job, picture, x, y, lane, lanes);
    }
  }
}

template <typename Grey>
void add_window(const FringeJob& job, const ImageView<Grey>& picture, FringeLanes& lanes) {
  if (job.is_bent)
    add_strips<Grey, true>(job, picture, lanes);
  else
    add_strips<Grey, false>(job, picture, lanes);
}

void Window8(const FringeJob& job, const ImageView<std::uint8_t>& p, FringeLanes& lanes) { add_window(job, p, lanes); }
void Window16(const FringeJob& job, const ImageView<std::uint16_t>& p, FringeLanes& lanes) {
  add_window(job, p, lanes);
}

}  // namespace HWY_NAMESPACE
// NOLINTEND(readability-function-size)
}  // namespace moiregauge::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace moiregauge::internal {
HWY_EXPORT(Window8);
HWY_EXPORT(Window16);

namespace {

FringeJob job_of(const FringeMap& map, const FringeRegion& region, const PixelBox& box, double background) {
  FringeJob job;
  job.x = (box.x0 + box.x1) / 2, job.y = (box.y0 + box.y1) / 2;
  Matrix3 from_middle;
  from_middle << 1, 0, job.x, 0, 1, job.y, 0, 0, 1;
  const Matrix3 h = map.from_image.matrix() * from_middle;
  for (int i = 0; i < 9; ++i) job.from_px[static_cast<std::size_t>(i)] = static_cast<float>(h(i / 3, i % 3) / h(2, 2));
  job.background = static_cast<float>(background);
  job.is_bent = map.is_bent;
  job.per_half = static_cast<float>(1.0 / map.half);
  for (std::size_t a = 0; a < 2; ++a) {
    for (std::size_t k = 0; k < 9; ++k) job.bend[a][k] = static_cast<float>(map.bend[a][k]);
  }
  job.box = box;
  const Matrix2 per_px = Homography<frame::Fringe, frame::Image>(h).jacobian({});
  for (std::size_t a = 0; a < 2; ++a) {
    const auto row = per_px.row(static_cast<Eigen::Index>(a));
    job.quarter_px[a] = static_cast<float>(0.25 * row.norm());
  }
  job.nodes = region.nodes;
  job.cell = static_cast<float>(region.side / region.nodes), job.low = static_cast<float>(-0.5 * region.side);
  job.window = static_cast<float>(region.window()) + std::max(job.quarter_px[0], job.quarter_px[1]);
  return job;
}

// Returns the area of the middle pixel, periods^2. The determinant of a homography's derivative is det(H) / w^3.
double middle_area(const FringeJob& job) {
  Matrix3 h;
  for (int i = 0; i < 9; ++i) h(i / 3, i % 3) = static_cast<double>(job.from_px[static_cast<std::size_t>(i)]);
  return std::abs(h.determinant());
}

// Returns the sum of sixteen lanes, added from the first.
double sum_of_lanes(const float (&lanes)[kStripWidth]) {
  double sum = 0.0;
  for (const float lane : lanes) sum += static_cast<double>(lane);
  return sum;
}

}  // namespace

std::array<FringeField, 2> fringe_nodes(const LumaView& luma, const FringeMap& map, const FringeRegion& region,
                                        const PixelBox& box, double background) {
  const FringeJob job = job_of(map, region, box, background);
  FringeLanes lanes;
  std::fill_n(&lanes.sums[0][0][0], region.nodes * region.nodes * kParts * kStripWidth, 0.0F);
  if (const auto* view = std::get_if<ImageView<std::uint8_t>>(&luma))
    HWY_DYNAMIC_DISPATCH(Window8)(job, *view, lanes);
  else
    HWY_DYNAMIC_DISPATCH(Window16)(job, *std::get_if<ImageView<std::uint16_t>>(&luma), lanes);
  const int n = region.nodes;
  const double cell = region.side / n, factor = 0.25 * middle_area(job) / (cell * cell);
  std::array<FringeField, 2> fields;
  for (FringeField& field : fields) field = {Image<std::complex<double>>(n, n), 0, 1.0 / cell};
  for (int l = 0; l < n; ++l) {
    for (int k = 0; k < n; ++k) {
      const auto& z = lanes.sums[l * n + k];
      fields[0].fringe.at(k, l) = factor * std::complex<double>(sum_of_lanes(z[0]), -sum_of_lanes(z[1]));
      fields[1].fringe.at(k, l) = factor * std::complex<double>(sum_of_lanes(z[2]), -sum_of_lanes(z[3]));
    }
  }
  return fields;
}

}  // namespace moiregauge::internal
#endif
