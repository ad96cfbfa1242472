// SPDX-License-Identifier: Apache-2.0
// Grey levels along a ray. Plain sums and products in double precision, nothing fused: the same on every SIMD target.
#pragma once

#include <cstdint>

#include "moiregauge/image/image.h"

namespace moiregauge::internal::markers_detail {

inline constexpr int kRayLanes = 8;  // profiles are written in whole lots of so many

struct RaySteps {
  double x = 0.0, y = 0.0;    // px, where it comes from
  double dx = 0.0, dy = 0.0;  // its direction
  double first = 0.0;         // px along it to the first sample
  double step = 0.0;          // px
  int samples = 0;            // at most 32
};

// Bilinear between pixels; all samples lie in the picture.
void sample_ray(const ImageView<std::uint8_t>& view, const RaySteps& ray, double* profile);
void sample_ray(const ImageView<std::uint16_t>& view, const RaySteps& ray, double* profile);

// Bit j: sign (profile - level) is below 0 at sample j and not at the next.
[[nodiscard]] std::uint32_t rises(const double* profile, int samples, double level, double sign);

// The value at place count / 2 when sorted; `values` in whole lots of memory.
[[nodiscard]] double median(const double* values, int count);

}  // namespace moiregauge::internal::markers_detail
