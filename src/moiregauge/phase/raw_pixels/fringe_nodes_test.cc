// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/phase/raw_pixels/fringe_nodes.h"

#include <cmath>
#include <optional>
#include <random>

#include <gtest/gtest.h>

#include "moiregauge/phase/fit/simd_target.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr int kSide = 170;
constexpr std::uint32_t kSeed = 20261124;

template <typename Grey>
Image<Grey> noise(unsigned most) {
  std::mt19937 rng(kSeed);
  Image<Grey> picture(kSide, kSide);
  for (int y = 0; y < kSide; ++y) {
    for (Grey& grey : picture.row(y)) grey = static_cast<Grey>(rng() % most);
  }
  return picture;
}

// A grating of 19 px per period, rolled, seen obliquely, and bent by a lens by up to 0.1 periods.
FringeMap oblique() {
  Matrix3 h;
  h << 0.049, 0.018, -5.6, -0.017, 0.050, -2.8, 2e-4, -1e-4, 1.0;
  FringeMap map{Homography<frame::Fringe, frame::Image>(h), true, 2.5, {}};
  map.bend[0] = {0.01, 0.02, -0.01, 0.0, 0.03, 0.01, 0.02, -0.01, 0.0};
  map.bend[1] = {-0.02, 0.0, 0.01, 0.03, -0.02, 0.0, 0.01, 0.02, -0.01};
  return map;
}

FringePoint place(const FringeMap& map, double x, double y) {
  const FringePoint p = map.from_image({x, y});
  FringePoint out = p;
  for (std::size_t k = 0; k < 9; ++k) {
    const double power = std::pow(p.x / map.half, k % 3) * std::pow(p.y / map.half, k / 3);
    out.x += map.bend[0][k] * power, out.y += map.bend[1][k] * power;
  }
  return out;
}

TEST(FringeNodes, GivesTheSameBitsOnEverySimdTarget) {
  const auto narrow = noise<std::uint8_t>(256);
  const auto wide = noise<std::uint16_t>(4096);
  const PixelBox box{3, 5, kSide - 1, kSide - 2};  // the last block of a row reaches beyond the image
  FringeMap flat = oblique();
  flat.is_bent = false;
  for (const FringeMap& map : {oblique(), flat}) {
    for (const LumaView& luma : {LumaView(narrow.view()), LumaView(wide.view())}) {
      std::optional<std::array<FringeField, 2>> first;
      for (const std::string& target : simd_targets()) {
        ASSERT_TRUE(use_simd_target(target));
        const auto now = fringe_nodes(luma, map, {3.0, 4}, box, 100.0);
        if (!first) first = now;
        for (std::size_t a = 0; a < 2; ++a) {
          for (int k = 0; k < 16; ++k)
            EXPECT_EQ(now[a].fringe.at(k % 4, k / 4), (*first)[a].fringe.at(k % 4, k / 4)) << target;
        }
      }
      ASSERT_TRUE(use_simd_target(simd_targets().front()));
    }
  }
}

TEST(FringeNodes, PhaseIsThatOfTheGratingUnderAnyMap) {
  const FringeMap map = oblique();
  constexpr double kPhaseX = 0.7, kPhaseY = -2.1;
  Image<std::uint16_t> picture(kSide, kSide);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const FringePoint p = place(map, x, y);
      const double level =
          30000.0 + 12000.0 * std::cos(kTwoPi * p.x + kPhaseX) + 9000.0 * std::cos(kTwoPi * p.y + kPhaseY);
      picture.at(x, y) = static_cast<std::uint16_t>(std::lround(level));
    }
  }
  const auto nodes = fringe_nodes(picture.view(), map, {2.9, 3}, {0, 0, kSide - 1, kSide - 1}, 29000.0);
  // rad. The cells differ in area by up to 10 % through the map's bend, which is not in the weights.
  constexpr double kMost = 2e-3;
  for (int k = 0; k < 9; ++k) {
    EXPECT_NEAR(std::arg(nodes[0].fringe.at(k % 3, k / 3)), kPhaseX, kMost);
    EXPECT_NEAR(std::arg(nodes[1].fringe.at(k % 3, k / 3)), kPhaseY, kMost);
    EXPECT_NEAR(2.0 * std::abs(nodes[0].fringe.at(k % 3, k / 3)), 12000.0, 0.1 * 12000.0);
  }
}

// The sum of pixels replaces the interpolation, the DFT and the mean. So it must give their result for any picture, not
// only for gratings.
TEST(FringeNodes, OfAnUprightWindowIsTheMeanOfTheSamplingMoireOfAnyPicture) {
  constexpr int kPitch = 16, kRegion = 33, kMiddle = kSide / 2;
  const auto picture = noise<std::uint16_t>(4096);
  Image<double> copy(kSide, kSide);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) copy.at(x, y) = picture.at(x, y);
  }
  Matrix3 h;
  h << 1.0 / kPitch, 0, -1.0 * kMiddle / kPitch, 0, 1.0 / kPitch, -1.0 * kMiddle / kPitch, 0, 0, 1;
  const FringeMap map{Homography<frame::Fringe, frame::Image>(h), false, 1.0, {}};
  const auto nodes = fringe_nodes(picture.view(), map, {1.0 * kRegion / kPitch, 1}, {10, 10, 160, 160}, 2000.0);
  for (std::size_t a = 0; a < 2; ++a) {
    const FringeField field = sampling_moire(copy.view(), a == 0 ? Axis::kX : Axis::kY, kPitch);
    std::complex<double> mean;
    double squares = 0.0;
    for (int y = -kRegion / 2; y <= kRegion / 2; ++y) {
      for (int x = -kRegion / 2; x <= kRegion / 2; ++x) {
        const int s = a == 0 ? x : y;
        const auto z = field.fringe.at(kMiddle - field.margin + x, kMiddle - field.margin + y);
        mean += z * std::polar(1.0, -kTwoPi * s / kPitch) / (1.0 * kRegion * kRegion);
        squares += std::norm(z) / (1.0 * kRegion * kRegion);
      }
    }
    // The textbook adds whole pixels of the region, the window integrates over it. They differ where the window bends.
    EXPECT_LT(std::abs(nodes[a].fringe.at(0, 0) - mean), 0.01 * std::sqrt(squares)) << a;
  }
}

}  // namespace
}  // namespace moiregauge::internal
