// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/reference/board_from_gratings.h"

#include <gtest/gtest.h>

#include <vector>

#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

// Returns the view of a board at about 40 degrees, with 3 px per mm.
IdealFromBoard tilted() {
  Matrix3 h;
  h << 3.0, 0.2, 512, 0.1, -2.3, 256, 1e-4, 4e-4, 1;
  return IdealFromBoard(h);
}

// Returns the result of an exact search for a grating: its local wave vectors.
DetectedPatch patch_at(const IdealFromBoard& view, BoardPoint at, double angle_rad, double pitch_mm) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  Matrix2 turn;
  turn << c, s, -s, c;
  const auto k_at = [&](BoardPoint p) -> Matrix2 { return turn * view.jacobian(p).inverse() / pitch_mm; };
  DetectedPatch patch;
  const auto place = [&](double x, double y) { return BoardPoint{at.x + c * x - s * y, at.y + s * x + c * y}; };
  const auto image = [&](BoardPoint p) { return ImagePoint{view(p).x, view(p).y}; };
  const Matrix2 k = k_at(at);
  patch.centre = image(at);
  patch.k_x = {k(0, 0), k(0, 1)};
  patch.k_y = {k(1, 0), k(1, 1)};
  for (std::size_t i = 0; i < 4; ++i) {
    const BoardPoint corner = place(i == 1 || i == 2 ? 20 : -20, i > 1 ? 20 : -20);
    patch.outline[i] = image(corner);
    const Matrix2 kc = k_at(corner);
    patch.k_corners[i] = {ImageExtent{kc(0, 0), kc(0, 1)}, ImageExtent{kc(1, 0), kc(1, 1)}};
  }
  return patch;
}

double board_distance(const BoardFromIdeal& board, const IdealFromBoard& view, BoardPoint a, BoardPoint b) {
  return length(board(view(a)) - board(view(b)));
}

TEST(BoardFromGratings, PitchesAloneMeasureTheBoard) {
  const IdealFromBoard view = tilted();
  std::vector<DetectedPatch> patches;
  for (const auto& [x, y, angle] : {std::array{-100.0, 40.0, 0.0}, std::array{100.0, 40.0, 0.3},
                                    std::array{-100.0, -40.0, -0.2}, std::array{100.0, -40.0, 0.7}})
    patches.push_back(patch_at(view, {x, y}, angle, 10.0));
  const BoardFromIdeal board = board_from_gratings(patches, Camera{}, 10.0);
  EXPECT_NEAR(board_distance(board, view, {-100, 40}, {100, -40}), std::hypot(200.0, 80.0), 1e-4);
  EXPECT_NEAR(board_distance(board, view, {0, 0}, {0, 30}), 30.0, 1e-4);
  for (const DetectedPatch& p : patches) EXPECT_NEAR(pitch_on(p, board, Camera{}), 10.0, 1e-5);
  const double first = print_angle(patches[0], board, Camera{});
  EXPECT_NEAR(std::remainder(print_angle(patches[1], board, Camera{}) - first - 0.3, 0.5 * kPi), 0.0, 1e-6);
}

TEST(BoardFromGratings, OneGratingIsEnoughWhereItsOwnPerspectiveShows) {
  const IdealFromBoard view = tilted();
  const std::vector<DetectedPatch> one{patch_at(view, {10, -5}, 0.1, 10.0)};
  const BoardFromIdeal board = board_from_gratings(one, Camera{}, 10.0);
  EXPECT_NEAR(board_distance(board, view, {-10, 0}, {30, 10}), std::hypot(40.0, 10.0), 1e-3);
}

TEST(BoardFromGratings, LinesMeasureTheirAxis) {
  const IdealFromBoard view = tilted();
  std::vector<DetectedPatch> patches;
  int n = 0;
  for (const auto& [x, y] :
       {std::pair{-100.0, 40.0}, {100.0, 40.0}, {-100.0, -40.0}, {100.0, -40.0}, {0.0, 60.0}, {0.0, -60.0}}) {
    patches.push_back(patch_at(view, {x, y}, 0.0, 10.0));
    patches.back().pattern = n++ % 2 == 0 ? Pattern::kLinesX : Pattern::kLinesY;
  }
  // Only a crossed grating shows that x and y are at right angles.
  patches.push_back(patch_at(view, {0, 0}, 0.0, 10.0));
  const BoardFromIdeal board = board_from_gratings(patches, Camera{}, 10.0);
  EXPECT_NEAR(board_distance(board, view, {-100, 40}, {100, -40}), std::hypot(200.0, 80.0), 1e-3);
}

TEST(BoardFromGratings, AnotherPitchIsMeasured) {
  const IdealFromBoard view = tilted();
  std::vector<DetectedPatch> patches;
  for (const auto& [x, y] : {std::pair{-100.0, 40.0}, {100.0, 40.0}, {-100.0, -40.0}, {100.0, -40.0}})
    patches.push_back(patch_at(view, {x, y}, 0.0, 10.0));
  const BoardFromIdeal board = board_from_gratings(patches, Camera{}, 10.0);
  EXPECT_NEAR(pitch_on(patch_at(view, {0, 0}, 0.4, 7.0), board, Camera{}), 7.0, 1e-4);
}

}  // namespace
}  // namespace moiregauge::internal
