// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/gratings/grating_patches.h"

#include <gtest/gtest.h>
#include <Eigen/LU>

#include "moiregauge/detection/gratings/painted_print_for_tests.h"
#include "moiregauge/detection/identity/grating_elements.h"

namespace moiregauge::internal {
namespace {

using testing::PaintedPrint;

PaintedPrint squares() {
  PaintedPrint print;
  print.centre = {128.3, 131.7};
  print.k = testing::lattice(22.0, 0.15);
  print.half_x = 2.25;
  print.half_y = 3.25;
  print.ink = testing::ink_of_squares;
  return print;
}

std::vector<DetectedPatch> patches_in(const Image<std::uint8_t>& picture) {
  return find_grating_patches(picture.view(), {});
}

std::vector<DetectedPatch> seen(const PaintedPrint& print, double fade = 0.0) {
  auto picture = testing::blank(256, 256);
  testing::paint(print, picture);
  testing::expose(picture, 1.5, fade);
  return patches_in(picture);
}

// Checks the extent along one axis. The outline may end 2.5 px inside the grating on either side: its margin of 1 px
// and the last strips. White gaps look like paper, so squares and dots may seem to reach `gap` (half a pitch) farther.
void expect_extent(double periods, double half, double pitch_px, double gap) {
  EXPECT_GT(periods, 2.0 * half - 2.0 * (2.5 / pitch_px)) << half;
  EXPECT_LT(periods, 2.0 * (half + gap)) << half;
}

TEST(GratingPatches, APatchReachesAsFarAsItsGrating) {
  const PaintedPrint print = squares();
  const auto found = seen(print);
  ASSERT_EQ(found.size(), 1U);
  expect_extent(found[0].periods_x, print.half_x, 22.0, 0.5);
  expect_extent(found[0].periods_y, print.half_y, 22.0, 0.5);
  EXPECT_LT(length(found[0].centre - print.centre), 4.0);
  EXPECT_NEAR(std::hypot(found[0].k_x.x, found[0].k_x.y), 1.0 / 22.0, 1.5e-3 / 22.0);
  EXPECT_GT(found[0].k_x.x, 0.0);  // rightwards
  EXPECT_LT(found[0].k_y.y, 0.0);  // upwards
}

TEST(GratingPatches, FadingLightDoesNotEndAGrating) {
  const auto even = seen(squares()), faded = seen(squares(), 0.7);
  ASSERT_EQ(even.size(), 1U);
  ASSERT_EQ(faded.size(), 1U);
  EXPECT_NEAR(faded[0].periods_x, even[0].periods_x, 3.0 / 22.0);
  EXPECT_NEAR(faded[0].periods_y, even[0].periods_y, 3.0 / 22.0);
}

TEST(GratingPatches, ACheckerboardRepeatsByTwoSquares) {
  for (const double pitch_px : {7.0, 12.0, 30.0}) {
    PaintedPrint print = squares();
    print.k = testing::lattice(pitch_px, 0.1);
    print.half_x = print.half_y = 3.0;
    print.ink = testing::ink_of_checkers;
    const auto found = seen(print);
    ASSERT_EQ(found.size(), 1U) << pitch_px;
    EXPECT_EQ(found[0].pattern, Pattern::kCheckerboard) << pitch_px;
    EXPECT_NEAR(std::hypot(found[0].k_x.x, found[0].k_x.y), 1.0 / pitch_px, 3e-3 / pitch_px);
    expect_extent(found[0].periods_x, print.half_x, pitch_px, 0.0);
  }
}

TEST(GratingPatches, LinesAreNamedByTheAxisAlongWhichTheGreyLevelVaries) {
  PaintedPrint print = squares();
  print.ink = [](double x, double) { return testing::square_wave(x); };
  auto found = seen(print);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].pattern, Pattern::kLinesX);
  print.ink = [](double, double y) { return testing::square_wave(y); };
  found = seen(print);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].pattern, Pattern::kLinesY);
}

TEST(GratingPatches, ThePatchExcludesTheCoveredPartOfAGrating) {
  const PaintedPrint print = squares();
  auto picture = testing::blank(256, 256);
  testing::paint(print, picture);
  for (int y = 0; y < 100; ++y) std::fill(picture.row(y).begin(), picture.row(y).end(), std::uint8_t{90});
  testing::expose(picture, 1.5);
  const auto found = patches_in(picture);
  ASSERT_EQ(found.size(), 1U);
  for (const ImagePoint corner : found[0].outline) EXPECT_GT(corner.y, 99.0);
}

TEST(GratingPatches, RoughnessIsNoGrating) {
  auto picture = testing::blank(256, 256);
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> place(0.0, 256.0), grey(40.0, 210.0), radius(4.0, 12.0);
  for (int blob = 0; blob < 1500; ++blob) {
    const double x0 = place(rng), y0 = place(rng), level = grey(rng), r = radius(rng);
    for (int y = std::max(0, static_cast<int>(y0 - r)); y < std::min(256.0, y0 + r); ++y) {
      for (int x = std::max(0, static_cast<int>(x0 - r)); x < std::min(256.0, x0 + r); ++x)
        if (std::hypot(x - x0, y - y0) < r) picture.at(x, y) = static_cast<std::uint8_t>(level);
    }
  }
  EXPECT_TRUE(patches_in(picture).empty());
  // A grating on the rough surface is still found.
  for (int y = 40; y < 224; ++y)
    std::fill(picture.row(y).begin() + 56, picture.row(y).begin() + 200, std::uint8_t{210});
  testing::paint(squares(), picture);
  EXPECT_EQ(patches_in(picture).size(), 1U);
}

TEST(GratingElements, DotsBeyondTheOutlineAreStillDots) {
  PaintedPrint print = squares();
  print.half_x = print.half_y = 5.0;
  print.ink = testing::ink_of_dots;
  std::vector<DetectedCircle> circles;
  for (int m = -4; m <= 4; ++m) {
    for (int n = -4; n <= 4; ++n) {
      const Eigen::Vector2d px = print.k.inverse() * Eigen::Vector2d(m, n);
      DetectedCircle c;
      c.centre = {print.centre.x + px.x(), print.centre.y + px.y()};
      c.diameter_px = 11.0;
      circles.push_back(c);
    }
  }
  DetectedCircle marker;  // twice the diameter of a dot, half a pitch off the raster
  marker.centre = print.centre + ImageExtent{11.0, 7.0 * 22.0};
  marker.diameter_px = 22.0;
  circles.push_back(marker);
  DetectedPatch patch;  // covers only the middle of the grating
  const Eigen::Matrix2d px = print.k.inverse();
  const auto corner = [&](double x, double y) {
    const Eigen::Vector2d p = px * Eigen::Vector2d(x, y);
    return ImagePoint{print.centre.x + p.x(), print.centre.y + p.y()};
  };
  patch.outline = {corner(-1.5, -1.5), corner(1.5, -1.5), corner(1.5, 1.5), corner(-1.5, 1.5)};
  patch.k_x = {print.k(0, 0), print.k(0, 1)};
  patch.k_y = {print.k(1, 0), print.k(1, 1)};
  const std::vector<DetectedPatch> patches{patch};
  const auto left = without_elements(circles, patches);
  ASSERT_EQ(left.size(), 1U);
  EXPECT_EQ(left[0].diameter_px, marker.diameter_px);
}

}  // namespace
}  // namespace moiregauge::internal
