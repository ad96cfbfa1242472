// SPDX-License-Identifier: Apache-2.0
// The look of rough surfaces.
#pragma once

#include <cstdint>

namespace moiregauge::internal::simulator {

// Three sizes of grain, 40, 9 and 2 mm, coarse ones stronger, as on concrete; scaled to an rms of 1.
[[nodiscard]] double roughness(std::uint64_t seed, double x_mm, double y_mm);

// One size of grain: mean 0, rms 1, never beyond 2.4. `x` and `y` are in grains.
[[nodiscard]] double grain(std::uint64_t seed, double x, double y);

}  // namespace moiregauge::internal::simulator
