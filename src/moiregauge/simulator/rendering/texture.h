// SPDX-License-Identifier: Apache-2.0
// Texture of rough surfaces.
#pragma once

#include <cstdint>

namespace moiregauge::internal::simulator {

// Returns a texture like concrete: grains of 40, 9 and 2 mm, coarse ones stronger, rms about 1.
[[nodiscard]] double roughness(std::uint64_t seed, double x_mm, double y_mm);

// Returns a texture of one grain size: mean 0, rms 1, at most 2.4 in absolute value. `x` and `y` are in grains.
[[nodiscard]] double grain(std::uint64_t seed, double x, double y);

}  // namespace moiregauge::internal::simulator
