// SPDX-License-Identifier: Apache-2.0
// Unit types for public interfaces, not used yet. All other numbers are doubles with the unit as a suffix
// (docs/conventions.md).
#pragma once

#include <cmath>
#include <compare>
#include <numbers>

namespace moiregauge::internal {

// A number with a unit. Its constructor is explicit, so that pixels cannot be used as millimetres.
template <typename Unit>
class Quantity {
 public:
  constexpr Quantity() = default;
  constexpr explicit Quantity(double value) : value_(value) {}
  [[nodiscard]] constexpr double value() const { return value_; }
  constexpr auto operator<=>(const Quantity&) const = default;
  constexpr Quantity operator-() const { return Quantity(-value_); }
  friend constexpr Quantity operator+(Quantity a, Quantity b) { return Quantity(a.value_ + b.value_); }
  friend constexpr Quantity operator-(Quantity a, Quantity b) { return Quantity(a.value_ - b.value_); }
  friend constexpr Quantity operator*(double s, Quantity a) { return Quantity(s * a.value_); }
  friend constexpr Quantity operator*(Quantity a, double s) { return Quantity(s * a.value_); }
  friend constexpr Quantity operator/(Quantity a, double s) { return Quantity(a.value_ / s); }
  friend constexpr double operator/(Quantity a, Quantity b) { return a.value_ / b.value_; }

 private:
  double value_ = 0.0;
};

using Pixels = Quantity<struct PixelUnit>;
using Millimetres = Quantity<struct MillimetreUnit>;
using Radians = Quantity<struct RadianUnit>;
using Seconds = Quantity<struct SecondUnit>;

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kTwoPi = 2.0 * std::numbers::pi;  // radians

[[nodiscard]] constexpr double radians_from_degrees(double degrees) { return degrees * (kPi / 180.0); }
[[nodiscard]] constexpr double degrees_from_radians(double radians) { return radians * (180.0 / kPi); }

// Returns the same angle in [-pi, pi], rad.
[[nodiscard]] inline double wrapped(double radians) { return std::remainder(radians, kTwoPi); }

// A value with its standard uncertainty.
template <typename Unit>
struct Measured {
  Quantity<Unit> value;
  Quantity<Unit> standard_uncertainty;  // k = 1
};

}  // namespace moiregauge::internal
