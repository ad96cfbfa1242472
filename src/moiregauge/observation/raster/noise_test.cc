// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/raster/noise.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

// Whole grey levels hide up to half a level, evenly distributed: 1 / sqrt(12).
TEST(PixelNoise, ContainsTheRoundingToWholeGreyLevels) {
  const Image<std::uint8_t> flat(40, 40, 120);
  EXPECT_NEAR(pixel_noise(flat.view(), 8).sigma, 1.0 / std::sqrt(12.0), 1e-12);
  EXPECT_NEAR(pixel_noise(part_of(flat.view(), 0, 0, 2, 2), 8).sigma, 1.0 / std::sqrt(12.0), 1e-12);
}

// The median of 158^2 magnitudes, of which neighbours correlate, scatters by about 2 %.
TEST(PixelNoise, OfABinaryGratingIsThatOfItsFlatParts) {
  std::mt19937 rng(20261124);
  std::normal_distribution<double> noise(0.0, 3.0);
  Image<std::uint8_t> picture(160, 160);
  for (int y = 0; y < 160; ++y) {
    for (int x = 0; x < 160; ++x) {
      const double level = (x / 10) % 2 == 0 && (y / 10) % 2 == 0 ? 60.0 : 180.0;
      picture.at(x, y) = static_cast<std::uint8_t>(std::lround(level + noise(rng)));
    }
  }
  EXPECT_NEAR(pixel_noise(picture.view(), 8).sigma, 3.0, 0.3);
}

}  // namespace
}  // namespace moiregauge::internal
