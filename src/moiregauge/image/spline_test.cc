// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/image/spline.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include <gtest/gtest.h>

#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

template <typename Level>
Image<double> picture(int width, int height, const Level& level) {
  Image<double> out(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) out.at(x, y) = level(x, y);
  }
  return out;
}

Spline through(const Image<double>& levels) {
  Spline spline;
  spline.fit(levels.view(), 0, 0, levels.width(), levels.height());
  return spline;
}

double read(const Spline& spline, double x, double y) {
  double grey = std::nan("");
  EXPECT_TRUE(spline.at(x, y, grey)) << x << ", " << y;
  return grey;
}

TEST(Spline, GoesThroughEveryPixel) {
  const auto levels =
      picture(37, 23, [](int x, int y) { return 100.0 + 80.0 * std::sin(1.7 * x * x + 0.9 * x * y + y); });
  const Spline spline = through(levels);
  for (int y = 1; y < 21; ++y) {
    for (int x = 1; x < 35; ++x) EXPECT_NEAR(read(spline, x, y), levels.at(x, y), 1e-11);
  }
}

TEST(Spline, ACubicIsItsOwnSplineFarFromTheEdge) {
  const auto level = [](double x, double y) { return 3e-4 * x * x * x - 0.02 * x * x * y + 0.1 * y * y - x + 7.0; };
  const Spline spline = through(picture(120, 120, level));
  // The mirror image at the edge bends it. The effect decreases by 0.27 per px: 1e-23 after 40 px.
  for (const double t : {0.0, 0.25, 0.5, 0.9}) EXPECT_NEAR(read(spline, 55 + t, 61 - t), level(55 + t, 61 - t), 1e-8);
}

TEST(Spline, APartOfAPictureIsReadInThePicturesCoordinates) {
  const auto levels = picture(80, 60, [](int x, int y) { return 2.0 * x - 3.0 * y; });
  Spline spline;
  spline.fit(levels.view(), 20, 10, 50, 40);
  EXPECT_NEAR(read(spline, 44.3, 30.6), 2.0 * 44.3 - 3.0 * 30.6, 1e-5);  // 20 px from the part's edge
  double grey = -1.0;
  EXPECT_FALSE(spline.at(20.9, 30.0, grey));
  EXPECT_FALSE(spline.at(68.0, 30.0, grey));
  EXPECT_FALSE(spline.at(44.0, std::nan(""), grey));
  EXPECT_EQ(grey, -1.0);
}

// With two points per pixel, always at the same positions, the image of the fringe at 2 - 1/P cycles per px falls on
// the fringe. For the spline its share is sinc^4(2 - 1/P) / ((2 + cos 2 pi/P) / 3).
TEST(Spline, TheAliasOfAFringeFollowsTheSpectrumOfTheSpline) {
  const double pitch = 7.0, place = 0.3;
  const auto cosine = picture(120, 9, [&](int x, int) { return std::cos(kTwoPi * x / pitch); });
  const Spline spline = through(cosine);
  std::complex<double> fringe;
  for (int i = 0; i < 140; ++i) {
    const double x = 20 + place + 0.5 * i;
    fringe += std::polar(1.0 / 70.0, -kTwoPi * x / pitch) * read(spline, x, 4.0);
  }
  const double away = 2.0 - 1.0 / pitch;
  const double share = std::pow(std::sin(kPi * away) / (kPi * away), 4) * 3.0 / (2.0 + std::cos(kTwoPi / pitch));
  const double moved = std::abs(std::arg(fringe));
  EXPECT_LE(moved, 2.0 * share);   // images at 2 - 1/P and, with half the strength, at 2 + 1/P
  EXPECT_GE(moved, 0.05 * share);  // the images exist
  EXPECT_LE(moved * pitch / kTwoPi, 1e-4);
}

}  // namespace
}  // namespace moiregauge::internal
