// SPDX-License-Identifier: Apache-2.0
// Simulated photographs of boards with a known camera, rendered here pixel by pixel. The calibration must find the
// camera within its stated uncertainty for all patterns.
#include <cmath>
#include <random>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "moiregauge/board/board_calibration.h"
#include "moiregauge/geometry/view.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr double kPitch = 10.0;  // mm
constexpr int kSamples = 4;      // per pixel and axis
constexpr double kNoise = 1.5;   // grey levels
constexpr std::uint64_t kSeed = 3;

const Camera kCamera{800, 600, 900.0, 900.0, 410.0, 290.0, -0.12, 0.03, 0.001, -0.0005, 0.0};

// Returns true for white at a point of the pattern, in mm from the middle of the board.
using Print = bool (*)(double x, double y);
double part(double v) { return v - std::floor(v); }
bool checkerboard(double x, double y) {
  return (std::floor(x / 5.0) + std::floor(y / 5.0)) * 0.5 ==
         std::floor((std::floor(x / 5.0) + std::floor(y / 5.0)) * 0.5);
}
bool dots(double x, double y) { return std::hypot(part(x / kPitch) - 0.5, part(y / kPitch) - 0.5) > 0.28; }
bool squares(double x, double y) { return part(x / kPitch) > 0.5 || part(y / kPitch) > 0.5; }
bool grid(double x, double y) { return part(x / kPitch) > 0.3 && part(y / kPitch) > 0.3; }

IdealFromBoard seen_from(double tilt_x, double tilt_y, double turn) {
  using Eigen::AngleAxisd, Eigen::Vector3d;
  const double deg = kPi / 180.0;
  const Eigen::Matrix3d r = (AngleAxisd(tilt_x * deg, Vector3d::UnitX()) * AngleAxisd(tilt_y * deg, Vector3d::UnitY()) *
                             AngleAxisd(turn * deg, Vector3d::UnitZ()))
                                .toRotationMatrix();
  Eigen::Matrix3d k, h;
  k << kCamera.fx, 0, kCamera.cx, 0, kCamera.fy, kCamera.cy, 0, 0, 1;
  h << r.col(0), -r.col(1), Vector3d(0.5 * tilt_y, -0.3 * tilt_x, 185.0);
  return IdealFromBoard(k * h);
}

Image<std::uint8_t> photograph(Print print, const IdealFromBoard& view, std::mt19937_64& rng) {
  std::normal_distribution<double> noise(0.0, kNoise);
  Image<std::uint8_t> picture(kCamera.width, kCamera.height);
  const auto board = view.inverse();
  // Distortion is removed at the pixels' corners. Within a pixel linear interpolation has an error of 1e-4 px.
  std::vector<IdealPoint> above, below;
  const auto corners = [](int y) {
    std::vector<IdealPoint> row;
    for (int x = 0; x <= kCamera.width; ++x) row.push_back(kCamera.undistort({x - 0.5, y - 0.5}));
    return row;
  };
  below = corners(0);
  for (int y = 0; y < kCamera.height; ++y) {
    above = std::exchange(below, corners(y + 1));
    for (std::size_t x = 0; x < above.size() - 1; ++x) {
      int white = 0;
      for (int k = 0; k < kSamples * kSamples; ++k) {
        const double u = (k % kSamples + 0.5) / kSamples, v = (k / kSamples + 0.5) / kSamples;
        const IdealPoint p{
            (1 - v) * ((1 - u) * above[x].x + u * above[x + 1].x) + v * ((1 - u) * below[x].x + u * below[x + 1].x),
            (1 - v) * ((1 - u) * above[x].y + u * above[x + 1].y) + v * ((1 - u) * below[x].y + u * below[x + 1].y)};
        const BoardPoint at = board(p);
        white += std::abs(at.x) > 60.0 || std::abs(at.y) > 50.0 || print(at.x, at.y) ? 1 : 0;
      }
      const double grey = 40.0 + 170.0 * white / (kSamples * kSamples) + noise(rng);
      picture.row(y)[x] = static_cast<std::uint8_t>(std::lround(grey));
    }
  }
  return picture;
}

struct Board {
  std::string name;
  Print print;
  BoardPattern pattern;
};

class SimulatedBoards : public ::testing::TestWithParam<Board> {};

TEST_P(SimulatedBoards, TheCameraIsWithinItsStatedUncertainty) {
  std::mt19937_64 rng(kSeed);
  std::vector<BoardView> views;
  for (const auto& [tx, ty, turn] :
       {std::array{30.0, 0.0, 4.0}, {-25.0, 20.0, -8.0}, {5.0, -32.0, 12.0}, {20.0, 25.0, 3.0}}) {
    const auto picture = photograph(GetParam().print, seen_from(tx, ty, turn), rng);
    const auto board = find_board({picture.view(), 8});
    ASSERT_TRUE(board) << "tilt " << tx << " " << ty;
    EXPECT_EQ(board->pattern, GetParam().pattern);
    EXPECT_GE(board->points.size(), 40U);
    views.push_back(board_view(*board, kPitch, kCamera.width, kCamera.height));
  }
  const auto solved = calibrate_board(views, {});
  ASSERT_TRUE(solved) << solved.error();
  const Camera& c = solved->camera;
  const double off[]{c.fx - kCamera.fx, c.cx - kCamera.cx, c.cy - kCamera.cy, c.k1 - kCamera.k1,
                     c.k2 - kCamera.k2, c.p1 - kCamera.p1, c.p2 - kCamera.p2};
  for (std::size_t k = 0; k < 7; ++k) {
    RecordProperty("off_in_u_" + std::to_string(k), std::to_string(off[k] / solved->u[k]));
    EXPECT_LE(std::abs(off[k]), 3.0 * solved->u[k]) << "parameter " << k << ", seed " << kSeed;
  }
  RecordProperty("rms_px", std::to_string(solved->rms_px));
  EXPECT_LE(solved->u[0] / c.fx, 0.01);
  for (const CalibratedView& view : solved->views) {
    EXPECT_EQ(view.excluded, "");
    EXPECT_LE(view.null.corners, 0.1);
    EXPECT_GE(view.null.corners_seen, view.null.corners);
  }
}

INSTANTIATE_TEST_SUITE_P(Prints, SimulatedBoards,
                         ::testing::Values(Board{"Checkerboard", checkerboard, BoardPattern::kCheckerboard},
                                           Board{"Dots", dots, BoardPattern::kDots},
                                           Board{"Squares", squares, BoardPattern::kGrating},
                                           Board{"Grid", grid, BoardPattern::kGrating}),
                         [](const auto& param) { return param.param.name; });

}  // namespace
}  // namespace moiregauge::internal
