// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/circles/radial_profile.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "moiregauge/image/lane_steps.h"
#include "moiregauge/image/simd_options.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "moiregauge/detection/circles/radial_profile.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace moiregauge::internal::markers_detail {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Real = hn::CappedTag<double, kRayLanes>;
using Whole = hn::Rebind<std::int32_t, Real>;
constexpr int kLanes = static_cast<int>(hn::MaxLanes(Real()));

constexpr int kMax = 32;  // samples of a ray

// Returns first, first + 1, ... .
HWY_INLINE auto lanes_from(int first) {
  const Real d;
  return hn::Add(hn::Load(d, kLaneSteps<double>), hn::Set(d, first));
}

// Intermediate values of all samples. Separate passes over arrays avoid a wait for each store before its load.
struct Samples {
  alignas(64) double fx[kMax], fy[kMax];      // px from the upper left of the four neighbouring pixels
  alignas(64) std::int32_t x[kMax], y[kMax];  // px, position of that upper left pixel
  alignas(64) std::int32_t level[4][kMax];    // grey levels: upper left, upper right, lower left, lower right
};

template <typename Grey>
HWY_INLINE void place(const ImageView<Grey>& view, const RaySteps& ray, Samples& s) {
  const Real d;
  const Whole di;
  for (int j = 0; j < ray.samples; j += kLanes) {
    const auto along = hn::Add(hn::Set(d, ray.first), hn::Mul(hn::Set(d, ray.step), lanes_from(j)));
    const auto x = hn::Add(hn::Set(d, ray.x), hn::Mul(along, hn::Set(d, ray.dx)));
    const auto y = hn::Add(hn::Set(d, ray.y), hn::Mul(along, hn::Set(d, ray.dy)));
    const auto ix = hn::Min(hn::DemoteTo(di, x), hn::Set(di, view.width - 2));
    const auto iy = hn::Min(hn::DemoteTo(di, y), hn::Set(di, view.height - 2));
    hn::Store(ix, di, s.x + j);
    hn::Store(iy, di, s.y + j);
    hn::Store(hn::Sub(x, hn::PromoteTo(d, ix)), d, s.fx + j);
    hn::Store(hn::Sub(y, hn::PromoteTo(d, iy)), d, s.fy + j);
  }
}

// Reads only the valid samples. The rest of the last vector may be outside the image.
template <typename Grey>
HWY_INLINE void look(const ImageView<Grey>& view, int samples, Samples& s) {
  for (int j = 0; j < samples; ++j) {
    const Grey* const p = view.data + s.y[j] * view.stride + s.x[j];
    s.level[0][j] = p[0];
    s.level[1][j] = p[1];
    s.level[2][j] = p[view.stride];
    s.level[3][j] = p[view.stride + 1];
  }
}

HWY_INLINE void interpolate(const Samples& s, int samples, double* profile) {
  const Real d;
  const Whole di;
  for (int j = 0; j < samples; j += kLanes) {
    const auto fx = hn::Load(d, s.fx + j), fy = hn::Load(d, s.fy + j);
    const auto between = [&](const std::int32_t* a, const std::int32_t* b) {
      const auto from = hn::Load(di, a + j), to = hn::Load(di, b + j);
      return hn::Add(hn::PromoteTo(d, from), hn::Mul(fx, hn::PromoteTo(d, hn::Sub(to, from))));
    };
    const auto upper = between(s.level[0], s.level[1]), lower = between(s.level[2], s.level[3]);
    hn::StoreU(hn::Add(upper, hn::Mul(fy, hn::Sub(lower, upper))), d, profile + j);
  }
}

template <typename Grey>
HWY_INLINE void Sample(const ImageView<Grey>& view, const RaySteps& ray, double* profile) {
  Samples s;
  std::memset(s.level, 0, sizeof s.level);
  place(view, ray, s);
  look(view, ray.samples, s);
  interpolate(s, ray.samples, profile);
}

void Sample8(const ImageView<std::uint8_t>& view, const RaySteps& ray, double* profile) { Sample(view, ray, profile); }
void Sample16(const ImageView<std::uint16_t>& view, const RaySteps& ray, double* profile) {
  Sample(view, ray, profile);
}

std::uint32_t Rises(const double* profile, int samples, double level, double sign) {
  const Real d;
  const auto height = [&](int j) {
    return hn::Mul(hn::Set(d, sign), hn::Sub(hn::LoadU(d, profile + j), hn::Set(d, level)));
  };
  std::uint32_t bits = 0;
  for (int j = 0; j + 1 < samples; j += kLanes) {
    std::uint8_t some[8] = {};
    const auto zero = hn::Zero(d);
    hn::StoreMaskBits(d, hn::And(hn::Lt(height(j), zero), hn::Ge(height(j + 1), zero)), some);
    bits |= std::uint32_t{some[0]} << j;
  }
  return bits & ((std::uint32_t{1} << (samples - 1)) - 1);
}

// Returns the largest value that has at most count / 2 smaller ones. Comparisons without branches are faster than a
// sort for so few values.
double Median(const double* values, int count) {
  const Real d;
  const auto half = hn::Set(d, count / 2), one = hn::Set(d, 1.0), end = hn::Set(d, count);
  const auto least = hn::Set(d, std::numeric_limits<double>::lowest());
  auto largest = least;
  for (int i = 0; i < count; i += kLanes) {
    const auto value = hn::LoadU(d, values + i);
    auto below = hn::Zero(d);
    for (int j = 0; j < count; ++j)
      below = hn::Add(below, hn::IfThenElseZero(hn::Lt(hn::Set(d, values[j]), value), one));
    const auto is_one = hn::And(hn::Le(below, half), hn::Lt(lanes_from(i), end));
    largest = hn::Max(largest, hn::IfThenElse(is_one, value, least));
  }
  double lanes[kLanes];
  hn::StoreU(largest, d, lanes);
  return *std::max_element(lanes, lanes + kLanes);
}

}  // namespace HWY_NAMESPACE
}  // namespace moiregauge::internal::markers_detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace moiregauge::internal::markers_detail {

HWY_EXPORT(Sample8);
HWY_EXPORT(Sample16);
HWY_EXPORT(Rises);
HWY_EXPORT(Median);

void sample_ray(const ImageView<std::uint8_t>& view, const RaySteps& ray, double* profile) {
  HWY_DYNAMIC_DISPATCH(Sample8)(view, ray, profile);
}
void sample_ray(const ImageView<std::uint16_t>& view, const RaySteps& ray, double* profile) {
  HWY_DYNAMIC_DISPATCH(Sample16)(view, ray, profile);
}
std::uint32_t rises(const double* profile, int samples, double level, double sign) {
  return HWY_DYNAMIC_DISPATCH(Rises)(profile, samples, level, sign);
}
double median(const double* values, int count) { return HWY_DYNAMIC_DISPATCH(Median)(values, count); }

}  // namespace moiregauge::internal::markers_detail
#endif
