// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/raster/pixel_sums.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "moiregauge/phase/fit/simd_target.h"

namespace moiregauge::internal {
namespace {

// A side that is no multiple of a vector, so that the last pixels of a row are read, too.
constexpr int kSide = 151;

template <typename Grey>
Image<Grey> speckled_square(int levels) {
  std::mt19937 random(7);
  Image<Grey> picture(kSide, kSide);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) picture.at(x, y) = static_cast<Grey>(random() % static_cast<unsigned>(levels));
  }
  return picture;
}

// Sums pixel by pixel by the definition.
template <typename Grey>
DiscSums summed_plainly(const Image<Grey>& picture, ImagePoint at, const DiscRadii& radii, int row_step) {
  DiscSums out;
  out.x0 = static_cast<int>(std::floor(at.x - radii.window)),
  out.y0 = static_cast<int>(std::floor(at.y - radii.window));
  for (int y = out.y0; y <= std::ceil(at.y + radii.window); y += row_step) {
    for (int x = out.x0; x <= std::ceil(at.x + radii.window); ++x) {
      const double away = std::hypot(x - at.x, y - at.y);
      const std::int64_t grey = picture.view().at(x, y);
      if (away > radii.window) continue;
      out.pixels += 1, out.x += x - out.x0, out.y += y - out.y0;
      out.grey += grey, out.grey_x += grey * (x - out.x0), out.grey_y += grey * (y - out.y0);
      if (away <= radii.ring) out.ring_pixels += 1, out.ring_grey += grey;
      if (away <= radii.middle) out.middle_pixels += 1, out.middle_grey += grey;
    }
  }
  return out;
}

void expect_same(const DiscSums& a, const DiscSums& b, const std::string& where) {
  EXPECT_EQ(a.pixels, b.pixels) << where;
  EXPECT_EQ(a.x, b.x) << where;
  EXPECT_EQ(a.y, b.y) << where;
  EXPECT_EQ(a.grey, b.grey) << where;
  EXPECT_EQ(a.grey_x, b.grey_x) << where;
  EXPECT_EQ(a.grey_y, b.grey_y) << where;
  EXPECT_EQ(a.ring_pixels, b.ring_pixels) << where;
  EXPECT_EQ(a.ring_grey, b.ring_grey) << where;
  EXPECT_EQ(a.middle_pixels, b.middle_pixels) << where;
  EXPECT_EQ(a.middle_grey, b.middle_grey) << where;
}

// 70 px of radius need more rows than one band, and reach the last columns of the image.
TEST(PixelSums, OfADiscEqualThoseOfEachPixelOnEverySimdTarget) {
  const auto narrow = speckled_square<std::uint8_t>(256);
  const auto wide = speckled_square<std::uint16_t>(65536);
  const ImagePoint at{79.4, 75.3};
  for (const std::string& target : simd_targets()) {
    ASSERT_TRUE(use_simd_target(target));
    for (const int row_step : {1, 3}) {
      for (const double radius : {9.5, 70.2}) {
        const DiscRadii radii{radius, 0.9 * radius, 0.56 * radius};
        expect_same(sum_disc(narrow.view(), at, radii, row_step), summed_plainly(narrow, at, radii, row_step), target);
        expect_same(sum_disc(wide.view(), at, radii, row_step), summed_plainly(wide, at, radii, row_step), target);
      }
    }
  }
  ASSERT_TRUE(use_simd_target(simd_targets().front()));
}

TEST(PixelSums, CountBlackAndWhitePixelsOnEverySimdTarget) {
  const auto narrow = speckled_square<std::uint8_t>(256);
  const auto wide = speckled_square<std::uint16_t>(4096);
  const auto counted = [](const auto& picture, int white) {
    long n = 0;
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) n += picture.view().at(x, y) == 0 || picture.view().at(x, y) >= white ? 1 : 0;
    }
    return n;
  };
  for (const std::string& target : simd_targets()) {
    ASSERT_TRUE(use_simd_target(target));
    EXPECT_EQ(count_clipped(narrow.view(), 255), counted(narrow, 255)) << target;
    EXPECT_EQ(count_clipped(wide.view(), 4095), counted(wide, 4095)) << target;
  }
  ASSERT_TRUE(use_simd_target(simd_targets().front()));
}

}  // namespace
}  // namespace moiregauge::internal
