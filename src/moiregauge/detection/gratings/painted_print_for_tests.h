// SPDX-License-Identifier: Apache-2.0
// Gratings painted into an image through a projective lattice: the truth for the tests of the detection.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>

#include <Eigen/Dense>

#include "moiregauge/image/image.h"
#include "moiregauge/units/point.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::testing {

// Position s in pitches at image point p: s = k x / (1 + q . x), with x = p - centre in px.
struct PaintedPrint {
  ImagePoint centre{100, 100};                                                     // px
  Eigen::Matrix2d k = Eigen::Matrix2d::Identity() / 20.0;                          // per px; rows: x right, y up
  Eigen::Vector2d q{0, 0};                                                         // per px
  double half_x = 2.0, half_y = 2.0;                                               // pitches
  std::function<double(double, double)> ink = [](double, double) { return 1.0; };  // 0 (paper) to 1 (black) at s
};

inline double square_wave(double s) { return std::abs(std::remainder(s, 1.0)) < 0.25 ? 1.0 : 0.0; }
inline double ink_of_squares(double x, double y) { return square_wave(x) * square_wave(y); }
inline double ink_of_checkers(double x, double y) {
  return (square_wave(x) > 0.5) == (square_wave(y) > 0.5) ? 1.0 : 0.0;
}
inline double ink_of_dots(double x, double y) {
  return std::hypot(std::remainder(x, 1.0), std::remainder(y, 1.0)) < 0.25 ? 1.0 : 0.0;
}

inline Eigen::Matrix2d lattice(double pitch_px, double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  Eigen::Matrix2d k;
  k << c, -s, -s, -c;  // image y goes down
  return k / pitch_px;
}

// Returns white paper of 210 grey levels.
inline Image<std::uint8_t> blank(int width, int height) {
  Image<std::uint8_t> picture(width, height);
  for (int y = 0; y < height; ++y) std::fill(picture.row(y).begin(), picture.row(y).end(), std::uint8_t{210});
  return picture;
}

// Paints the grating with ink of 40 grey levels. Each pixel is the mean of 6 x 6 points.
inline void paint(const PaintedPrint& print, Image<std::uint8_t>& picture) {
  constexpr int kFine = 6;
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      double ink = 0.0;
      for (int i = 0; i < kFine * kFine; ++i) {
        const Eigen::Vector2d at(x + (i % kFine + 0.5) / kFine - 0.5 - print.centre.x,
                                 y + (i / kFine + 0.5) / kFine - 0.5 - print.centre.y);
        const Eigen::Vector2d s = print.k * at / (1.0 + print.q.dot(at));
        if (std::abs(s.x()) < print.half_x && std::abs(s.y()) < print.half_y) ink += print.ink(s.x(), s.y());
      }
      if (ink > 0.0) picture.at(x, y) = static_cast<std::uint8_t>(std::lround(210.0 - 170.0 * ink / (kFine * kFine)));
    }
  }
}

// Adds Gaussian noise (sigma in grey levels, fixed seed) and light that falls by the share `fade` from left to right.
inline void expose(Image<std::uint8_t>& picture, double sigma, double fade = 0.0) {
  std::mt19937 rng(7);
  std::normal_distribution<double> noise(0.0, sigma);
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      const double light = 1.0 - fade * x / picture.width();
      picture.at(x, y) =
          static_cast<std::uint8_t>(std::clamp(std::lround(light * picture.at(x, y) + noise(rng)), 0L, 255L));
    }
  }
}

}  // namespace moiregauge::internal::testing
