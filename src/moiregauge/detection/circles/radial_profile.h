// SPDX-License-Identifier: Apache-2.0
// Grey levels along a ray, and their level crossings. Sums and products in double precision without fused operations,
// so the bits are the same on every SIMD target.
#pragma once

#include <cstdint>

#include "moiregauge/image/image.h"

namespace moiregauge::internal::markers_detail {

inline constexpr int kRayLanes = 8;  // samples: the size of a profile must be a multiple of this

struct RaySteps {
  double x = 0.0, y = 0.0;    // px, origin of the ray
  double dx = 0.0, dy = 0.0;  // direction, unit vector
  double first = 0.0;         // px from the origin to the first sample
  double step = 0.0;          // px between samples
  int samples = 0;            // at most 32
};

// Samples the image along a ray by bilinear interpolation. All samples must be inside the image.
void sample_ray(const ImageView<std::uint8_t>& view, const RaySteps& ray, double* profile);
void sample_ray(const ImageView<std::uint16_t>& view, const RaySteps& ray, double* profile);

// Returns the upward crossings of a level as bits. Bit j is set if sign * (profile - level) is below 0 at sample j and
// not at sample j + 1.
[[nodiscard]] std::uint32_t rises(const double* profile, int samples, double level, double sign);

// Returns the element at index count / 2 of the sorted values. The memory at `values` must be a multiple of kRayLanes.
[[nodiscard]] double median(const double* values, int count);

}  // namespace moiregauge::internal::markers_detail
