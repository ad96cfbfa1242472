// SPDX-License-Identifier: Apache-2.0
// Interpolation of grey levels between the pixels, precise enough for short pitches.
#pragma once

#include <vector>

#include "moiregauge/image/image.h"

namespace moiregauge::internal {

// Margin around the pixels that are read, px. It keeps them free of the effect of the part's edge (0.27^12 = 1e-7).
inline constexpr int kSplineRim = 12;

// Cubic spline through the pixels of a part of an image (M. Unser, IEEE Signal Processing Magazine 16(6), 1999,
// doi:10.1109/79.799930).
// If all points are at the same position between two pixels, interpolation creates an alias. It folds the image of a
// fringe of pitch P at 2 - 1/P cycles per px onto the fringe. For P = 7 px cubic convolution leaves 8e-4 of the
// amplitude, or 0.001 px. The spline leaves 4e-5, with the same 16 pixels per point.
class Spline {
 public:
  // Fits the spline. The image beyond the part is assumed to be its mirror image. The effect of a wrong neighbour
  // decreases by 0.27 per px of distance.
  template <typename Grey>
  void fit(const ImageView<Grey>& picture, int x0, int y0, int width, int height) {
    x0_ = x0;
    y0_ = y0;
    if (coefficients_.width() != width || coefficients_.height() != height)
      coefficients_ = Image<double>(width, height);
    for (int y = 0; y < height; ++y) {
      const Grey* in = picture.data + (y0 + y) * picture.stride + x0;
      for (double& c : coefficients_.row(y)) c = static_cast<double>(*in++);
    }
    prefilter();
  }

  // Reads the grey level at (x, y) px of the image.
  // Fails (false, `grey` unchanged): the part does not contain all 4 x 4 pixels around the point.
  [[nodiscard]] bool at(double x, double y, double& grey) const {
    const double u = x - x0_, v = y - y0_;
    if (!(u >= 1.0 && v >= 1.0 && u < coefficients_.width() - 2 && v < coefficients_.height() - 2)) return false;
    const int column = static_cast<int>(u), row = static_cast<int>(v);
    const Weights across(u - column), down(v - row);
    double sum = 0.0;
    for (int j = 0; j < 4; ++j) {
      const double* c = coefficients_.row(row + j - 1).data() + column - 1;
      sum += down.w[j] * (across.w[0] * c[0] + across.w[1] * c[1] + across.w[2] * c[2] + across.w[3] * c[3]);
    }
    grey = sum;
    return true;
  }

 private:
  struct Weights {
    double w[4];
    explicit Weights(double t)
        : w{(1.0 - t) * (1.0 - t) * (1.0 - t) / 6.0, 2.0 / 3.0 - 0.5 * t * t * (2.0 - t),
            2.0 / 3.0 - 0.5 * (1.0 - t) * (1.0 - t) * (1.0 + t), t * t * t / 6.0} {}
  };

  void prefilter();

  int x0_ = 0, y0_ = 0;
  Image<double> coefficients_;
};

}  // namespace moiregauge::internal
