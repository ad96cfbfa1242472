// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/print/pixel_locking.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "moiregauge/phase/fit/template_for_tests.h"

namespace moiregauge::internal {
namespace {

constexpr int kLinePitch = 29;     // px
constexpr int kLockingOrder = 13;  // pitch / 2.2

// Returns the grey level of a pixel at x px from the middle of a dark line. The pixel averages a blurred edge.
double line_pixel(double x, double half_width, double psf) {
  constexpr int kParts = 32;
  double sum = 0.0;
  for (int k = 0; k < kParts; ++k) {
    const double at = std::remainder(x + (k + 0.5) / kParts - 0.5, kLinePitch);
    sum += std::erf((half_width - at) / (std::sqrt(2.0) * psf)) + std::erf((half_width + at) / (std::sqrt(2.0) * psf));
  }
  return 200.0 - 85.0 * sum / kParts;
}

// Returns the largest error (px) of a shift that is fitted to the pixels of one pitch. The template comes from the
// pixels of the unshifted line.
double largest_shift_error(double half_width, double psf) {
  std::vector<std::complex<double>> series(kLockingOrder + 1);
  for (int m = 1; m <= kLockingOrder; ++m) {
    for (int n = 0; n < kLinePitch; ++n)
      series[static_cast<std::size_t>(m)] +=
          line_pixel(n, half_width, psf) * std::polar(1.0 / kLinePitch, -kTwoPi * m * n / kLinePitch);
  }
  double largest = 0.0;
  for (double shift = 0.0; shift < 1.0; shift += 0.05) {
    double product = 0.0, power = 0.0, mean = 0.0;
    for (int n = 0; n < kLinePitch; ++n) mean += line_pixel(n - shift, half_width, psf) / kLinePitch;
    for (int n = 0; n < kLinePitch; ++n) {
      double level = mean, slope = 0.0;
      for (int m = 1; m <= kLockingOrder; ++m) {
        const double k = kTwoPi * m / kLinePitch;
        const auto c = series[static_cast<std::size_t>(m)] * std::polar(2.0, k * (n - shift));
        level += c.real(), slope += k * c.imag();
      }
      product += slope * (line_pixel(n - shift, half_width, psf) - level), power += slope * slope;
    }
    largest = std::max(largest, std::abs(product / power));
  }
  return largest;
}

PrintModel lines_template(double half_width, double psf) {
  PrintModel model;
  model.print = testing::template_of(kLockingOrder,
                                     [&](double x, double) { return line_pixel(kLinePitch * x, half_width, psf); });
  model.options.along_y = false;
  model.window = {{0.0, 0.0}, 2.0, 2.0};
  return model;
}

// Returns the fit of a grating of `pitch` px, whose lines shift by `slant` px along their length of four pitches.
PatchFit lines_fit(double pitch, double slant, double shift) {
  PatchFit fit;
  Matrix3 image_from_window;
  image_from_window << 2.0 * pitch, 0.5 * slant, shift, 0.0, 2.0 * pitch, 0.0, 0.0, 0.0, 1.0;
  fit.window_from_image = Homography<frame::Image, frame::Window>(image_from_window).inverse();
  for (int n = 0; n < kPatchPoints; ++n) {
    const PrintPoint p{(n % 3 - 1) * 4.0 / 3.0, (n / 3 - 1) * 4.0 / 3.0};
    fit.print[static_cast<std::size_t>(n)] = p;
    fit.image[static_cast<std::size_t>(n)] = {pitch * p.x, pitch * p.y};
  }
  fit.gain = {1.0, 0.0, 0.0};
  fit.sigma = 0.1;
  fit.pixels = 10000;
  return fit;
}

// The error depends on the width of the lines relative to the pixels, which the template's tail does not show. The stated
// amplitude is that of the worst width. The envelope of the orders is known to a factor of three.
TEST(PixelLocking, IsThatOfTheFitToSampledLines) {
  for (const double psf : {0.3, 0.4, 0.5}) {
    double found = 0.0, stated = 0.0;
    for (const double half_width : {3.5, 4.5, 5.5}) {
      found = std::max(found, largest_shift_error(half_width, psf));
      stated = std::max(
          stated, kLinePitch * expected_locking(lines_template(half_width, psf), lines_fit(kLinePitch, 0.0, 0.0))[0]);
    }
    EXPECT_GT(found, 0.003) << psf;
    EXPECT_GT(stated, found) << psf;
    EXPECT_LT(stated, 3.0 * found) << psf;
  }
}

TEST(PixelLocking, IsNotStatedBehindAUsualBlur) {
  const auto none = expected_locking(lines_template(4.5, 0.8), lines_fit(kLinePitch, 0.0, 0.0));
  EXPECT_EQ(none[0], 0.0);
  EXPECT_EQ(none[1], 0.0);
}

TEST(PixelLocking, LinesAtAllFractionsOfAPixelCancel) {
  const PatchWindow window{{0.0, 0.0}, 2.0, 2.0};
  EXPECT_NEAR(std::abs(pixel_phase(lines_fit(29.0, 0.0, 0.3), window)[0]), 1.0, 1e-9);
  EXPECT_NEAR(std::abs(pixel_phase(lines_fit(29.0, 1.0, 0.3), window)[0]), 0.0, 1e-9) << "turned by a pixel";
  EXPECT_NEAR(std::abs(pixel_phase(lines_fit(28.5, 0.0, 0.3), window)[0]), 0.2, 1e-9)
      << "five lines, half a pixel apart";
  const auto at_rest = pixel_phase(lines_fit(29.0, 0.0, 0.0), window),
             moved = pixel_phase(lines_fit(29.0, 0.0, 0.5), window);
  EXPECT_NEAR(std::abs(moved[0] - at_rest[0]), 2.0, 1e-9);
  EXPECT_NEAR(std::abs(moved[1] - at_rest[1]), 0.0, 1e-9);
}

}  // namespace
}  // namespace moiregauge::internal
