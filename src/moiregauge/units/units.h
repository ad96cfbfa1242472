// SPDX-License-Identifier: Apache-2.0
// Angles: constants and conversions. Numbers carry their unit as a suffix (docs/conventions.md).
#pragma once

#include <cmath>
#include <numbers>

namespace moiregauge::internal {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kTwoPi = 2.0 * std::numbers::pi;  // radians

[[nodiscard]] constexpr double radians_from_degrees(double degrees) { return degrees * (kPi / 180.0); }
[[nodiscard]] constexpr double degrees_from_radians(double radians) { return radians * (180.0 / kPi); }

// Returns the same angle in [-pi, pi], rad.
[[nodiscard]] inline double wrapped(double radians) { return std::remainder(radians, kTwoPi); }

}  // namespace moiregauge::internal
