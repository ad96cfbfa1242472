// SPDX-License-Identifier: Apache-2.0
// Quantities with a unit, for arguments that people mix up. Values inside results are doubles with the unit in the name.
#pragma once

#include <compare>
#include <string>

#include "moiregauge/errors.h"

namespace moiregauge {

// Number with a unit. It is built explicitly or by a literal, so pixels are never used as millimetres.
template <typename Unit>
class Quantity {
 public:
  constexpr Quantity() = default;
  constexpr explicit Quantity(double value) : value_(value) {}
  // Returns the number in the unit of the type.
  [[nodiscard]] constexpr double value() const { return value_; }
  constexpr auto operator<=>(const Quantity&) const = default;
  friend constexpr Quantity operator+(Quantity a, Quantity b) { return Quantity(a.value_ + b.value_); }
  friend constexpr Quantity operator-(Quantity a, Quantity b) { return Quantity(a.value_ - b.value_); }
  friend constexpr Quantity operator*(double factor, Quantity a) { return Quantity(factor * a.value_); }

 private:
  double value_ = 0.0;
};

using Millimetres = Quantity<struct MillimetreUnit>;
using Seconds = Quantity<struct SecondUnit>;

// Literals: 10_mm, 2.5_cm, 0.01_m, 100_um, 1_in; 20_ms, 1.5_s.
inline namespace literals {

constexpr Millimetres operator""_mm(long double value) { return Millimetres(static_cast<double>(value)); }
constexpr Millimetres operator""_mm(unsigned long long value) { return Millimetres(static_cast<double>(value)); }
constexpr Millimetres operator""_cm(long double value) { return Millimetres(10.0 * static_cast<double>(value)); }
constexpr Millimetres operator""_cm(unsigned long long value) { return Millimetres(10.0 * static_cast<double>(value)); }
constexpr Millimetres operator""_m(long double value) { return Millimetres(1000.0 * static_cast<double>(value)); }
constexpr Millimetres operator""_m(unsigned long long value) {
  return Millimetres(1000.0 * static_cast<double>(value));
}
constexpr Millimetres operator""_um(long double value) { return Millimetres(0.001 * static_cast<double>(value)); }
constexpr Millimetres operator""_um(unsigned long long value) {
  return Millimetres(0.001 * static_cast<double>(value));
}
constexpr Millimetres operator""_in(long double value) { return Millimetres(25.4 * static_cast<double>(value)); }
constexpr Millimetres operator""_in(unsigned long long value) { return Millimetres(25.4 * static_cast<double>(value)); }
constexpr Seconds operator""_s(long double value) { return Seconds(static_cast<double>(value)); }
constexpr Seconds operator""_s(unsigned long long value) { return Seconds(static_cast<double>(value)); }
constexpr Seconds operator""_ms(long double value) { return Seconds(0.001 * static_cast<double>(value)); }
constexpr Seconds operator""_ms(unsigned long long value) { return Seconds(0.001 * static_cast<double>(value)); }

}  // namespace literals

// Reads a length such as "10mm", "0.4in" or "1 cm", as the command line does.
// Fails (kUsage): no unit, an unknown one, or a length that is not above 0.
[[nodiscard]] MOIREGAUGE_API Expected<Millimetres> read_length(const std::string& text);

// Reads a duration such as "18ms" or "1.5s", as the command line does.
// Fails (kUsage): no unit, an unknown one, or a negative duration.
[[nodiscard]] MOIREGAUGE_API Expected<Seconds> read_duration(const std::string& text);

}  // namespace moiregauge
