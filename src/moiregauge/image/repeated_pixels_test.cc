// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/image/repeated_pixels.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

// Returns a picture of waves along two axes that are rotated by 0.05 rad. Every pixel shows the scene at the top left
// corner of the larger pixel that contains it. `wave`: grey levels at a position, px.
template <typename Wave>
Image<std::uint8_t> crossed(Wave wave, double pixel_size, double noise, unsigned seed) {
  constexpr int kPictureSide = 200;
  std::mt19937 random(seed);
  std::normal_distribution<double> grain(0.0, 1.0);
  Image<std::uint8_t> picture(kPictureSide, kPictureSide);
  for (int y = 0; y < kPictureSide; ++y) {
    for (int x = 0; x < kPictureSide; ++x) {
      const double u = pixel_size * std::floor(x / pixel_size), v = pixel_size * std::floor(y / pixel_size);
      const double grey = 120.0 + wave(u + 0.05 * v) + wave(v - 0.05 * u) + noise * grain(random);
      picture.at(x, y) = static_cast<std::uint8_t>(std::lround(grey));
    }
  }
  return picture;
}

// Dark lines every 20 px. Their edges rise from 10 to 90 % within 1.4 px.
Image<std::uint8_t> lines(double pixel_size, double noise) {
  return crossed([](double at) { return 45.0 * std::tanh(5.0 * std::sin(2.0 * M_PI * at / 20.0)); }, pixel_size, noise,
                 11);
}

double share(double pixel_size, double noise) {
  const auto picture = lines(pixel_size, noise);
  const SlopeSteps steps = count_slope_steps(picture.view(), 15.0);
  EXPECT_GT(steps.all, 200);
  return static_cast<double>(steps.repeated) / static_cast<double>(steps.all);
}

TEST(RepeatedPixels, AreCountedInAnEnlargedImage) {
  EXPECT_LT(share(1.0, 0.0), 0.02);
  EXPECT_LT(share(1.0, 2.0), 0.02);
  // Three pixels enlarged to four repeat one of them. Two enlarged to three repeat every other one.
  EXPECT_NEAR(share(4.0 / 3.0, 0.0), 1.0 / 3.0, 0.12);
  EXPECT_NEAR(share(1.5, 0.0), 0.5, 0.12);
  EXPECT_GT(share(2.0, 0.0), 0.9);
  EXPECT_GT(share(3.0, 0.0), 0.9);
}

// A cosine of 12 px with the amplitude of 20 grey levels has slopes, but no edges. Noise of 3 grey levels often makes
// neighbours equal there.
TEST(RepeatedPixels, EqualLevelsByNoiseAreNotCounted) {
  const auto picture = crossed([](double at) { return 10.0 * std::cos(2.0 * M_PI * at / 12.0); }, 1.0, 3.0, 12);
  const SlopeSteps steps = count_slope_steps(picture.view(), 0.08 * 40.0);
  EXPECT_GT(steps.all, 200);
  EXPECT_EQ(steps.repeated, 0);
}

}  // namespace
}  // namespace moiregauge::internal
