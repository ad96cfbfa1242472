// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/report/page_picture.h"

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "moiregauge/drawing/surface/png_bytes.h"
#include "moiregauge/drawing/surface/surface.h"

namespace moiregauge::internal {
namespace {

constexpr std::uint64_t kSeedOfNoise = 20261122;

// An image with sensor noise, which PNG cannot compress.
std::vector<std::uint8_t> noisy_png(int width, int height) {
  std::mt19937_64 random(kSeedOfNoise);
  std::normal_distribution<double> noise(128.0, 4.0);
  Image<std::uint8_t> picture(width, height);
  for (int y = 0; y < height; ++y)
    for (std::uint8_t& grey : picture.row(y)) grey = static_cast<std::uint8_t>(std::clamp(noise(random), 0.0, 255.0));
  const Surface surface = grey_surface(picture.view());
  return png_of(surface.get());
}

bool is_jpeg(const std::vector<std::uint8_t>& bytes) {
  return bytes.size() > 2 && bytes[0] == 0xff && bytes[1] == 0xd8;
}

// Bound: 1600 x 390 px at two bits each = 156 kB.
TEST(PagePicture, ALargeImageIsShrunk) {
  const auto png = noisy_png(4100, 1000);
  const auto page = page_picture(png);
  EXPECT_GT(png.size(), 2000000U);
  EXPECT_TRUE(is_jpeg(page));
  EXPECT_LT(page.size(), 160000U);
}

TEST(PagePicture, ASmallImageIsUnchanged) {
  const Image<std::uint8_t> white(64, 48, 255);
  const Surface surface = grey_surface(white.view());
  const auto png = png_of(surface.get());
  EXPECT_EQ(page_picture(png), png);
}

TEST(PagePicture, AnUnreadableImageIsUnchanged) {
  const std::vector<std::uint8_t> torn{0x89, 'P', 'N', 'G', 1, 2, 3};
  EXPECT_EQ(page_picture(torn), torn);
  EXPECT_TRUE(page_picture({}).empty());
}

}  // namespace
}  // namespace moiregauge::internal
