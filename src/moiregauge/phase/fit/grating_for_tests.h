// SPDX-License-Identifier: Apache-2.0
// Gratings with a known phase, exact to rounding, for the tests of this module.
#pragma once

#include <cmath>
#include <random>

#include "moiregauge/image/image.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::testing {

struct Grating {
  double pitch_px = 29.0;
  double shift_x_px = 0.0;  // towards larger coordinates
  double shift_y_px = 0.0;
  double amplitude = 42.5;
  double background = 125.0;
};

// Returns a crossed cosine grating. Without a shift its phase is zero at the centre of the image.
inline Image<double> crossed_cosine(int width, int height, const Grating& g) {
  Image<double> picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      picture.at(x, y) = g.background +
                         g.amplitude * std::cos(kTwoPi * (x - 0.5 * (width - 1) - g.shift_x_px) / g.pitch_px) +
                         g.amplitude * std::cos(kTwoPi * (y - 0.5 * (height - 1) - g.shift_y_px) / g.pitch_px);
    }
  }
  return picture;
}

// Returns the level (0 to 1) at `s` px of bars half a pitch wide, behind a Gaussian blur of sigma px. The blur makes
// the Fourier series finite to rounding.
inline double blurred_bars(double s, double pitch_px, double sigma_px) {
  double value = 0.5;
  for (int m = 1; m <= 61; m += 2) {
    const double blur = std::exp(-0.5 * std::pow(kTwoPi * m * sigma_px / pitch_px, 2));
    value += 2.0 / (kPi * m) * ((m / 2) % 2 == 0 ? 1.0 : -1.0) * blur * std::cos(kTwoPi * m * s / pitch_px);
  }
  return value;
}

// Returns light squares (210 on 40) where two sets of bars cross. Pixel and lens blur together have sigma = 0.757 px.
inline Image<double> crossed_binary(int width, int height, const Grating& g) {
  Image<double> picture(width, height);
  for (int y = 0; y < height; ++y) {
    const double bar_y = blurred_bars(y - 0.5 * (height - 1) - g.shift_y_px, g.pitch_px, 0.757);
    for (int x = 0; x < width; ++x) {
      const double bar_x = blurred_bars(x - 0.5 * (width - 1) - g.shift_x_px, g.pitch_px, 0.757);
      picture.at(x, y) = 40.0 + 170.0 * bar_x * bar_y;
    }
  }
  return picture;
}

inline Image<double> random_picture(int width, int height, std::mt19937_64& rng) {
  std::uniform_real_distribution<double> grey(0.0, 255.0);
  Image<double> picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (double& value : picture.row(y)) value = grey(rng);
  }
  return picture;
}

}  // namespace moiregauge::internal::testing
