// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "moiregauge/detection/lattices/indexed_lattice.h"
#include "moiregauge/geometry/homography.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr std::uint64_t kCheckerSeed = 20240613;
constexpr int kBoardWidth = 320, kBoardHeight = 260;
constexpr int kColumns = 9, kRows = 6;  // squares

using PictureFromBoard = Homography<frame::Image, frame::Board>;  // board in squares, y down

PictureFromBoard view_of_board(double tilt_deg, double roll_rad) {
  const double s = std::sin(radians_from_degrees(tilt_deg)), c = std::cos(radians_from_degrees(tilt_deg));
  Matrix3 centred, roll, pose, place;
  centred << 1, 0, -0.5 * kColumns, 0, 1, -0.5 * kRows, 0, 0, 1;
  roll << std::cos(roll_rad), -std::sin(roll_rad), 0, std::sin(roll_rad), std::cos(roll_rad), 0, 0, 0, 1;
  pose << 24.0, 0, 0, 0, 24.0 * c, 0, 0.02 * s, 0.03 * s, 1;  // 24 px per square
  place << 1, 0, 160.3, 0, 1, 129.6, 0, 0, 1;
  return PictureFromBoard(place * pose * roll * centred);
}

// Returns the square wave -1 to 1 with edges at integers, blurred by sigma (in squares).
double stripe(double x, double sigma) {
  const double line = std::round(x);
  return (std::lround(line) % 2 == 0 ? 1.0 : -1.0) * std::erf((x - line) / (sigma * std::sqrt(2.0)));
}

Image<std::uint8_t> checkerboard(const PictureFromBoard& picture_from_board, double noise_sigma, std::mt19937_64& rng) {
  std::normal_distribution<double> normal;
  const auto board_from_picture = picture_from_board.inverse();
  Image<std::uint8_t> out(kBoardWidth, kBoardHeight);
  for (int y = 0; y < kBoardHeight; ++y) {
    for (int x = 0; x < kBoardWidth; ++x) {
      const BoardPoint p = board_from_picture(ImagePoint{static_cast<double>(x), static_cast<double>(y)});
      const bool on_board = p.x > 0.0 && p.y > 0.0 && p.x < kColumns && p.y < kRows;
      const double light = on_board ? 0.5 - 0.5 * stripe(p.x, 0.035) * stripe(p.y, 0.035) : 1.0;
      const double grey = (50.0 + 130.0 * light) * (1.0 + 0.001 * (x - 160)) + noise_sigma * normal(rng);
      out.at(x, y) = static_cast<std::uint8_t>(std::clamp(grey + 0.5, 0.0, 255.0));
    }
  }
  return out;
}

TEST(CheckerLattice, InnerCornersOfATiltedBoardAreFoundToAFiftiethOfAPixel) {
  for (const double tilt : {0.0, 20.0, 40.0}) {
    for (const double roll : {0.0, 0.35}) {
      std::mt19937_64 rng(kCheckerSeed);
      const auto view = view_of_board(tilt, roll);
      const auto image = checkerboard(view, 0.0, rng);
      const auto lattices = find_checker_lattices(LumaView(image.view()), 8);
      ASSERT_EQ(lattices.size(), 1U) << tilt << " deg";
      EXPECT_EQ(lattices[0].columns, kColumns - 1);
      EXPECT_EQ(lattices[0].rows, kRows - 1);
      ASSERT_TRUE(lattices[0].whole()) << tilt << " deg";
      EXPECT_TRUE(lattices[0].dark);
      // Rounding to grey levels alone moves a corner by 0.003 px.
      for (const LatticePoint& p : lattices[0].points)
        EXPECT_LT(length(p.at - view(BoardPoint{p.column + 1.0, p.row + 1.0})), 0.02) << tilt << " deg";
    }
  }
}

TEST(CheckerLattice, AnUpsideDownBoardWithOddAndEvenSidesHasTheOtherColourFirst) {
  std::mt19937_64 rng(kCheckerSeed);
  const auto image = checkerboard(view_of_board(20.0, kPi), 0.0, rng);
  const auto lattices = find_checker_lattices(LumaView(image.view()), 8);
  ASSERT_EQ(lattices.size(), 1U);
  EXPECT_FALSE(lattices[0].dark);
}

TEST(CheckerLattice, CornersScatterAsMuchAsTheirStandardUncertaintySays) {
  constexpr int kTrials = 4;
  std::mt19937_64 rng(kCheckerSeed);
  const auto view = view_of_board(25.0, 0.2);
  double squares = 0.0, stated = 0.0;
  int corners = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto image = checkerboard(view, 4.0, rng);
    const auto lattices = find_checker_lattices(LumaView(image.view()), 8);
    ASSERT_EQ(lattices.size(), 1U) << "seed " << kCheckerSeed;
    for (const LatticePoint& p : lattices[0].points) {
      const auto off = p.at - view(BoardPoint{p.column + 1.0, p.row + 1.0});
      squares += off.x * off.x + off.y * off.y;
      stated += 2.0 * p.u_px * p.u_px;
      ++corners;
    }
  }
  ASSERT_EQ(corners, kTrials * (kColumns - 1) * (kRows - 1));
  // The ratio has a relative standard error of 1 / sqrt(4 n), for two coordinates per corner. The limit is 4 of these,
  // plus 5 % for the model of the fit.
  EXPECT_NEAR(std::sqrt(squares / stated), 1.0, 0.05 + 4.0 / std::sqrt(4.0 * corners)) << "seed " << kCheckerSeed;
}

TEST(CheckerLattice, TheSaddlesBetweenDotsAreNoCorners) {
  Image<std::uint8_t> dots(kBoardWidth, kBoardHeight);
  for (int y = 0; y < kBoardHeight; ++y) {
    for (int x = 0; x < kBoardWidth; ++x) {
      const double r = std::hypot(std::remainder(x - 3.0, 20.0), std::remainder(y - 5.0, 20.0));
      dots.at(x, y) = static_cast<std::uint8_t>(180.0 - 65.0 * std::erfc(r - 6.0));
    }
  }
  EXPECT_TRUE(find_checker_lattices(LumaView(dots.view()), 8).empty());
}

TEST(CheckerLattice, ACosineGratingIsNoCheckerboard) {
  for (const double pitch : {12.3, 29.3, 61.0}) {
    Image<std::uint8_t> crossed(kBoardWidth, kBoardHeight);
    for (int y = 0; y < kBoardHeight; ++y) {
      for (int x = 0; x < kBoardWidth; ++x) {
        const double waves = std::cos(kTwoPi * x / pitch) + std::cos(kTwoPi * y / pitch);
        crossed.at(x, y) = static_cast<std::uint8_t>(110.5 + 35.0 * waves);
      }
    }
    EXPECT_TRUE(find_checker_lattices(LumaView(crossed.view()), 8).empty()) << pitch << " px";
  }
}

TEST(CheckerLattice, AnEmptyNoisyImageHasNone) {
  std::mt19937_64 rng(kCheckerSeed);
  std::normal_distribution<double> normal(120.0, 5.0);
  Image<std::uint8_t> noise(kBoardWidth, kBoardHeight);
  for (int y = 0; y < kBoardHeight; ++y) {
    for (std::uint8_t& grey : noise.row(y)) grey = static_cast<std::uint8_t>(normal(rng));
  }
  EXPECT_TRUE(find_checker_lattices(LumaView(noise.view()), 8).empty()) << "seed " << kCheckerSeed;
}

}  // namespace
}  // namespace moiregauge::internal
