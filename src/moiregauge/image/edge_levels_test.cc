// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/image/edge_levels.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

constexpr int kPictureSide_px = 80;
constexpr double kDiameter_px = 46.0;
constexpr double kCentre_px = 39.3;  // not a pixel centre

// A dark disc with a Gaussian edge of sigma 0.7 px and noise of 1.5 grey levels, behind a tone curve of 0 to 1.
Image<std::uint8_t> rendered_disc(const std::function<double(double)>& tone) {
  std::mt19937 random(3);
  std::normal_distribution<double> grain(0.0, 1.5);
  Image<std::uint8_t> picture(kPictureSide_px, kPictureSide_px);
  for (int y = 0; y < kPictureSide_px; ++y) {
    for (int x = 0; x < kPictureSide_px; ++x) {
      const double outside = std::hypot(x - kCentre_px, y - kCentre_px) - 0.5 * kDiameter_px;
      const double grey = 40.0 + 170.0 * 0.5 * std::erfc(-outside / (0.7 * std::sqrt(2.0))) + grain(random);
      picture.at(x, y) = static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(tone(grey / 255.0), 0.0, 1.0)));
    }
  }
  return picture;
}

double emptiest_share(const std::function<double(double)>& tone) {
  const auto picture = rendered_disc(tone);
  EdgeLevels levels;
  levels.add_disc(picture.view(), kCentre_px, kCentre_px, kDiameter_px);
  EXPECT_GT(levels.all(), 100);  // 0.7 of the circumference of 145 px
  return static_cast<double>(levels.in_emptiest_range()) / static_cast<double>(levels.all());
}

// The levels of a Gaussian edge are rarest in the middle. In quantiles of the normal distribution, 0.35 to 0.65 has
// 0.77 / 2.07 = 0.37 of 0.15 to 0.85. About 250 pixels scatter by 0.03, and four of these are allowed.
TEST(EdgeLevels, OfABlurredDiscCoverTheWholeRange) {
  EXPECT_GT(emptiest_share([](double v) { return v; }), 0.37 - 0.12);
  EXPECT_GT(emptiest_share([](double v) { return std::pow(v, 1 / 2.2); }), 0.2);
  EXPECT_GT(emptiest_share([](double v) { return v * v * (3.0 - 2.0 * v); }), 0.2);  // an S-curve
}

TEST(EdgeLevels, LackARangeBehindAToneCurveWithAStep) {
  EXPECT_LT(emptiest_share([](double v) { return v < 0.43 ? 0.3 * v : 0.35 + 0.5 * v; }), 0.05);
  EXPECT_LT(emptiest_share([](double v) { return v < 0.45 ? 0.1 : 0.9; }), 0.05);
}

TEST(EdgeLevels, OfADiscThatTheImageCutsOffDoNotCount) {
  const auto picture = rendered_disc([](double v) { return v; });
  EdgeLevels levels;
  levels.add_disc(picture.view(), kCentre_px + 15.0, kCentre_px, kDiameter_px);
  levels.add_disc(picture.view(), kCentre_px, kCentre_px, 0.0);
  EXPECT_EQ(levels.all(), 0);
}

}  // namespace
}  // namespace moiregauge::internal
