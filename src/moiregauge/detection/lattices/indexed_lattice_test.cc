// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/lattices/indexed_lattice.h"

#include <cmath>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "moiregauge/detection/circles/rendered_disc_for_tests.h"
#include "moiregauge/geometry/camera.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr std::uint64_t kLatticeSeed = 20240612;
constexpr int kWidth = 1200, kHeight = 900;

struct Board {
  int columns = 11, rows = 8;
  double pitch_px = 50.0;  // in the middle of the board, without tilt
  double tilt_rad = 0.0;
  double about_rad = 0.3;  // direction of the tilt's axis in the image
  double roll_rad = 0.1;   // rotation of the board in the image, from x towards y
  double barrel = 0.0;     // k1
  ImagePoint middle{600.0, 450.0};
};

// Projects a point by a pinhole camera of 1200 px with the board's middle on its axis, then by the lens. Moves the
// result to the middle stated by the board.
ImagePoint seen_at(const Board& board, double column, double row) {
  const double x = (column - 0.5 * (board.columns - 1)) * board.pitch_px,
               y = (row - 0.5 * (board.rows - 1)) * board.pitch_px;
  const double rx = std::cos(board.roll_rad) * x - std::sin(board.roll_rad) * y;
  const double ry = std::sin(board.roll_rad) * x + std::cos(board.roll_rad) * y;
  const double c = std::cos(board.about_rad), s = std::sin(board.about_rad);
  const double along = c * rx + s * ry, across = c * ry - s * rx;  // along and across the axis of the tilt
  const double lain = across * std::cos(board.tilt_rad), deep = 1200.0 + across * std::sin(board.tilt_rad);
  const double px = 1200.0 * (c * along - s * lain) / deep, py = 1200.0 * (s * along + c * lain) / deep;
  const Camera lens{.fx = 1200.0, .fy = 1200.0, .k1 = board.barrel};
  const ImagePoint p = lens.distort({px, py});
  return {board.middle.x + p.x, board.middle.y + p.y};
}

DetectedCircle circle_at(ImagePoint centre, double diameter = 18.0) {
  return {.centre = centre, .u_centre_px = 0.05, .diameter_px = diameter, .circularity = 0.95, .contrast = -100.0};
}

std::vector<DetectedCircle> dots_of(const Board& board) {
  std::vector<DetectedCircle> dots;
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) dots.push_back(circle_at(seen_at(board, column, row)));
  }
  return dots;
}

// Checks the column and row of all points against the projected board.
void expect_true_indices(const IndexedLattice& lattice, const Board& board) {
  for (const LatticePoint& p : lattice.points) {
    ASSERT_LT(length(p.at - seen_at(board, p.column, p.row)), 0.3) << "column " << p.column << ", row " << p.row;
  }
}

std::vector<DetectedCircle> scattered(int count, std::mt19937_64& rng) {
  std::uniform_real_distribution<double> x(0.0, kWidth), y(0.0, kHeight), size(14.0, 22.0);
  std::vector<DetectedCircle> circles;
  for (int i = 0; i < count; ++i) {
    const double px = x(rng), py = y(rng);
    circles.push_back(circle_at({px, py}, size(rng)));
  }
  return circles;
}

TEST(DotLattice, AllDotsOfATiltedBoardHaveTheirColumnAndRow) {
  for (const double tilt : {0.0, 20.0, 40.0, 50.0}) {
    for (const double about : {0.0, 0.4, 0.8, 1.2, 1.6}) {
      for (const double barrel : {0.0, -0.3}) {
        const Board board{.tilt_rad = radians_from_degrees(tilt), .about_rad = about, .barrel = barrel};
        const auto lattices = find_dot_lattices(dots_of(board));
        ASSERT_EQ(lattices.size(), 1U) << tilt << " deg about " << about << ", k1 " << barrel;
        EXPECT_TRUE(lattices[0].whole()) << tilt << " deg about " << about << ", k1 " << barrel;
        EXPECT_EQ(lattices[0].columns, board.columns);
        expect_true_indices(lattices[0], board);
      }
    }
  }
}

TEST(DotLattice, MissingDotsDoNotChangeTheIndicesOfTheOthers) {
  std::mt19937_64 rng(kLatticeSeed);
  std::bernoulli_distribution missing(0.2);
  const Board board{.tilt_rad = 0.6, .barrel = -0.2};
  std::vector<DetectedCircle> dots = dots_of(board);
  // Keeps the corners, which determine the first column and row.
  std::set<std::pair<int, int>> there;
  std::vector<DetectedCircle> seen;
  for (int i = 0; i < 88; ++i) {
    const bool corner = (i % 11 == 0 || i % 11 == 10) && (i / 11 == 0 || i / 11 == 7);
    if (missing(rng) && !corner) continue;
    there.insert({i % 11, i / 11});
    seen.push_back(dots[static_cast<std::size_t>(i)]);
  }
  const auto lattices = find_dot_lattices(seen);
  ASSERT_EQ(lattices.size(), 1U);
  for (const auto& [column, row] : there) {
    int neighbours = -1;  // the loop counts the dot itself
    for (int i = 0; i < 9; ++i) neighbours += there.contains({column + i % 3 - 1, row + i / 3 - 1}) ? 1 : 0;
    if (neighbours < 3) continue;
    EXPECT_NE(lattices[0].find(column, row), nullptr) << column << ", " << row << ", seed " << kLatticeSeed;
  }
  EXPECT_FALSE(lattices[0].whole());
  expect_true_indices(lattices[0], board);
}

TEST(DotLattice, ClutterAroundItIsNoPartOfIt) {
  std::mt19937_64 rng(kLatticeSeed);
  const Board board{.tilt_rad = 0.5};
  std::vector<DetectedCircle> seen = dots_of(board);
  for (const DetectedCircle& circle : scattered(60, rng)) seen.push_back(circle);
  const auto lattices = find_dot_lattices(seen);
  ASSERT_EQ(lattices.size(), 1U);
  EXPECT_TRUE(lattices[0].whole());
  expect_true_indices(lattices[0], board);
}

TEST(DotLattice, TwoSheetsAreTwoLatticesTheLargerOneFirst) {
  const Board large{.columns = 8, .rows = 7, .tilt_rad = 0.4, .middle = {300.0, 450.0}};
  const Board small{
      .columns = 5, .rows = 4, .pitch_px = 43.0, .tilt_rad = 0.4, .roll_rad = -0.4, .middle = {900.0, 450.0}};
  std::vector<DetectedCircle> seen = dots_of(small);
  for (const DetectedCircle& dot : dots_of(large)) seen.push_back(dot);
  const auto lattices = find_dot_lattices(seen);
  ASSERT_EQ(lattices.size(), 2U);
  EXPECT_TRUE(lattices[0].whole());
  EXPECT_TRUE(lattices[1].whole());
  expect_true_indices(lattices[0], large);
  expect_true_indices(lattices[1], small);
}

TEST(DotLattice, OnlyTheVisiblePartOfABoardCutOffByTheFrameIsFound) {
  const Board board{.roll_rad = 0.0, .middle = {230.0, 450.0}};
  std::vector<DetectedCircle> seen;
  for (const DetectedCircle& dot : dots_of(board)) {
    if (dot.centre.x > 12.0) seen.push_back(dot);
  }
  const auto lattices = find_dot_lattices(seen);
  ASSERT_EQ(lattices.size(), 1U);
  EXPECT_EQ(lattices[0].points.size(), seen.size());
  EXPECT_EQ(lattices[0].columns, 10);
  EXPECT_EQ(lattices[0].rows, 8);
  EXPECT_TRUE(lattices[0].whole());
}

TEST(DotLattice, ScatteredCirclesAreNone) {
  std::mt19937_64 rng(kLatticeSeed);
  for (int trial = 0; trial < 20; ++trial) {
    EXPECT_TRUE(find_dot_lattices(scattered(200, rng)).empty()) << "seed " << kLatticeSeed << " trial " << trial;
  }
}

TEST(DotLattice, CirclesThatOnlyRoughlyKeepTheirDistanceAreNone) {
  std::mt19937_64 rng(kLatticeSeed);
  std::uniform_real_distribution<double> stray(-0.2, 0.2);  // relative to the pitch
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<DetectedCircle> heap = dots_of({});
    for (DetectedCircle& circle : heap) {
      circle.centre.x += stray(rng) * Board{}.pitch_px;
      circle.centre.y += stray(rng) * Board{}.pitch_px;
    }
    EXPECT_TRUE(find_dot_lattices(heap).empty()) << "seed " << kLatticeSeed << " trial " << trial;
  }
}

TEST(DotLattice, OneLargerDotInTheCornerAndHolesInOthersChangeNothing) {
  const Board board{.tilt_rad = 0.3};
  std::vector<DetectedCircle> seen = dots_of(board);
  seen[0].diameter_px *= 2.0;
  for (const std::size_t ring : {14U, 30U, 52U}) {
    DetectedCircle hole = seen[ring];
    hole.diameter_px *= 0.4;
    hole.contrast = 80.0;
    seen.push_back(hole);
  }
  const auto lattices = find_dot_lattices(seen);
  ASSERT_EQ(lattices.size(), 1U);
  EXPECT_TRUE(lattices[0].whole());
  EXPECT_TRUE(lattices[0].dark);
  EXPECT_NEAR(lattices[0].find(0, 0)->size_px, 36.0, 1e-9);
  expect_true_indices(lattices[0], board);
}

TEST(DotLattice, AMissedDotIsFoundAtItsPredictedPosition) {
  test::Scene scene;
  std::vector<double> share(static_cast<std::size_t>(scene.size * scene.size), 0.0);
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      const auto disc = test::coverage({22.3 + 27.0 * column, 21.7 + 26.0 * row, 9.0, 0.3, 0.5}, scene);
      for (std::size_t i = 0; i < share.size(); ++i) share[i] += disc[i];
    }
  }
  std::mt19937_64 rng(kLatticeSeed);
  const auto image = test::picture<std::uint8_t>(test::grey_levels(share, scene), scene.size, 1.0, 1.0, rng);
  const LumaView luma(image.view());
  std::vector<DetectedCircle> seen = find_circles(luma, {}).circles;
  ASSERT_EQ(seen.size(), 16U);
  const DetectedCircle lost = seen[2];
  seen.erase(seen.begin() + 2);
  ASSERT_FALSE(find_dot_lattices(seen)[0].whole());
  const auto lattices = find_dot_lattices(luma, seen);
  ASSERT_EQ(lattices.size(), 1U);
  EXPECT_TRUE(lattices[0].whole());  // no points beyond the edge of the board
  EXPECT_EQ(lattices[0].columns, 4);
  double least = 1e9;
  for (const LatticePoint& p : lattices[0].points) least = std::min(least, length(p.at - lost.centre));
  EXPECT_LT(least, 0.02 * lost.u_centre_px);  // same centre as by the first search
}

}  // namespace
}  // namespace moiregauge::internal
