// SPDX-License-Identifier: Apache-2.0
// Pictures of one grating of five pitches in the middle of a sheet, with noise, and the shift that a fit finds in them.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "moiregauge/geometry/view.h"
#include "moiregauge/image/image.h"
#include "moiregauge/phase/fit/patch_fit.h"
#include "moiregauge/site/site.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::test {

inline constexpr int kSide = 130;  // px
inline constexpr double kPitchPx = 20.37;
inline constexpr double kPitches = 5.0;  // size of the grating
inline constexpr double kNoise = 1.5;    // grey levels
inline constexpr double kBlurPx = 0.76;  // sigma of lens and pixel
inline constexpr double kPaper = 210.0;  // grey levels

// Returns a view in which a millimetre is a pixel. y is up.
inline View upright() {
  Matrix3 h;
  h << 1, 0, 0.5 * kSide, 0, -1, 0.5 * kSide, 0, 0, 1;
  return {IdealFromBoard(h), {}};
}

inline Grating print() {
  return {
      .centre = {0.0, 0.0}, .width_mm = kPitches * kPitchPx, .height_mm = kPitches * kPitchPx, .pitch_mm = kPitchPx};
}

inline double step(double px) { return 0.5 * std::erfc(-px / (std::sqrt(2.0) * kBlurPx)); }
// Returns the level of lines half a pitch wide about 0, 1, ... pitches: 0 in a line, 1 between.
inline double lines(double px) { return step(std::abs(std::remainder(px, kPitchPx)) - 0.25 * kPitchPx); }
// Returns lines of black ink on paper, and of a tint that takes this share of black's light.
inline double tinted_lines(double x, double y, double share) {
  return kPaper - 170.0 * share * (1.0 - lines(x) * lines(y));
}
inline double crossed_lines(double x, double y) { return tinted_lines(x, y, 1.0); }
inline double cosines(double x, double y) {
  return 125.0 + 42.5 * (std::cos(kTwoPi * x / kPitchPx) + std::cos(kTwoPi * y / kPitchPx));
}
inline bool is_inside(double x, double y) {
  return std::abs(x) <= 0.5 * kPitches * kPitchPx && std::abs(y) <= 0.5 * kPitches * kPitchPx;
}

// Returns the picture of a sheet. `grey`: level at a position from the middle, px.
template <typename Grey>
Image<std::uint8_t> sheet(Grey grey, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::normal_distribution<double> noise(0.0, kNoise);
  Image<std::uint8_t> picture(kSide, kSide);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const double px = x - 0.5 * kSide, py = 0.5 * kSide - y;
      picture.at(x, y) = static_cast<std::uint8_t>(std::lround(grey(px, py) + noise(rng)));
    }
  }
  return picture;
}

// Returns the picture of a grating on paper.
template <typename Grey>
Image<std::uint8_t> seen(Grey grey, std::uint64_t seed) {
  return sheet([&](double x, double y) { return is_inside(x, y) ? grey(x, y) : kPaper; }, seed);
}

// Shift of the whole grating along its x: the nine points relative to the map, weighted by their information.
struct Shift {
  double pitches = 0.0, u = 0.0;
};

inline Shift shift_of(const PatchFit& fit, const PrintFromImage& map) {
  Eigen::Matrix<double, 2 * kPatchPoints, 1> along = Eigen::Matrix<double, 2 * kPatchPoints, 1>::Zero(), off = along;
  for (int n = 0; n < kPatchPoints; ++n) {
    const auto i = static_cast<std::size_t>(n);
    const auto d = fit.print[i] - map(fit.image[i]);
    along(n) = 1.0, off(n) = d.x, off(kPatchPoints + n) = d.y;
  }
  const double information = along.dot(fit.information * along);
  return {along.dot(fit.information * off) / information, 1.0 / std::sqrt(information)};
}

}  // namespace moiregauge::internal::test
