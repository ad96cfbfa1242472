// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include "moiregauge/geometry/camera.h"
#include "moiregauge/geometry/homography.h"
#include "moiregauge/geometry/pose.h"

namespace moiregauge::internal {
namespace {

using ImageFromBoard = Homography<frame::Image, frame::Board>;

const ImageFromBoard kTilted((Matrix3() << 2.9, 0.1, 2050.0, 0.05, -2.9, 500.0, 1e-5, 2e-5, 1.0).finished());

TEST(Homography, FourPointsAreMappedExactly) {
  const std::array<BoardPoint, 4> board{{{-380, 28}, {380, 28}, {-380, -28}, {380, -28}}};
  std::array<ImagePoint, 4> image;
  for (std::size_t i = 0; i < 4; ++i) image[i] = kTilted(board[i]);
  const auto fitted = fit_homography<frame::Image, frame::Board>(board, image);
  ASSERT_TRUE(fitted);
  for (const BoardPoint p : {BoardPoint{0, 0}, BoardPoint{100, 20}, BoardPoint{-350, -10}}) {
    EXPECT_LT(length((*fitted)(p)-kTilted(p)), 1e-9);  // 1e-16 relative x 2000 px x condition of the flat layout
  }
}

TEST(Homography, ThreePointsOnALineDetermineNothing) {
  const std::array<BoardPoint, 4> board{{{0, 0}, {1, 1}, {2, 2}, {5, 0}}};
  std::array<ImagePoint, 4> image;
  for (std::size_t i = 0; i < 4; ++i) image[i] = kTilted(board[i]);
  const auto fitted = fit_homography<frame::Image, frame::Board>(board, image);
  ASSERT_FALSE(fitted);
  EXPECT_EQ(fitted.error(), HomographyFailure::kDegenerate);
}

TEST(Homography, NoMovementOfThePointsLowersTheLeastSquaresError) {
  std::mt19937_64 rng(20261121);
  std::normal_distribution<double> noise(0.0, 0.1);
  std::vector<BoardPoint> board;
  std::vector<ImagePoint> image;
  for (int x = -300; x <= 300; x += 100) {
    for (int y = -30; y <= 30; y += 30) {
      board.push_back({double(x), double(y)});
      const ImagePoint p = kTilted(board.back());
      image.push_back({p.x + noise(rng), p.y + noise(rng)});
    }
  }
  const auto fitted = fit_homography<frame::Image, frame::Board>(board, image);
  ASSERT_TRUE(fitted);
  const auto cost = [&](const Matrix3& h) {
    double sum = 0.0;
    for (std::size_t i = 0; i < board.size(); ++i) {
      const auto d = ImageFromBoard(h)(board[i]) - image[i];
      sum += d.x * d.x + d.y * d.y;
    }
    return sum;
  };
  const double best = cost(fitted->matrix());
  for (int i = 0; i < 8; ++i) {
    for (const double sign : {-1.0, 1.0}) {
      Matrix3 h = fitted->matrix();
      h(i / 3, i % 3) += sign * 1e-4 * std::max(1e-4, std::abs(h(i / 3, i % 3)));
      EXPECT_GE(cost(h), best);
    }
  }
}

TEST(Homography, TheJacobianIsTheDerivative) {
  const BoardPoint p{120.0, -17.0};
  constexpr double kStep = 1e-4;
  const Matrix2 j = kTilted.jacobian(p);
  const auto dx = kTilted({p.x + kStep, p.y}) - kTilted({p.x - kStep, p.y});
  const auto dy = kTilted({p.x, p.y + kStep}) - kTilted({p.x, p.y - kStep});
  EXPECT_NEAR(j(0, 0), dx.x / (2 * kStep), 1e-6);
  EXPECT_NEAR(j(1, 0), dx.y / (2 * kStep), 1e-6);
  EXPECT_NEAR(j(0, 1), dy.x / (2 * kStep), 1e-6);
  EXPECT_NEAR(j(1, 1), dy.y / (2 * kStep), 1e-6);
}

TEST(Homography, TurningTheCameraDoesNotMoveTheBoard) {
  const Matrix3 camera = (Matrix3() << 3478.26, 0, 2059.3, 0, 3478.26, 494.3, 0, 0, 1).finished();
  const double a = 4.0 * 3.14159265358979323846 / 180.0;
  const Matrix3 turn = (Eigen::AngleAxisd(a, Eigen::Vector3d::UnitX()) *
                        Eigen::AngleAxisd(a, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(a, Eigen::Vector3d::UnitZ()))
                           .toRotationMatrix();
  const Homography<frame::Image, frame::Ideal> now_from_then(camera * turn * camera.inverse());
  const std::array<IdealPoint, 4> then{{{960, 420}, {3160, 420}, {960, 580}, {3160, 580}}};
  std::array<ImagePoint, 4> now;
  for (std::size_t i = 0; i < 4; ++i) now[i] = now_from_then(then[i]);
  const auto back = fit_homography<frame::Ideal, frame::Image>(now, then);
  ASSERT_TRUE(back);
  const IdealPoint centre = (*back)(now_from_then(IdealPoint{2052.0, 500.0}));
  EXPECT_NEAR(centre.x, 2052.0, 1e-6);
  EXPECT_NEAR(centre.y, 500.0, 1e-6);
}

TEST(Camera, UndistortingUndoesTheLens) {
  const Camera camera{4104, 1012, 3478.26, 3478.26, 2059.3, 494.3, -0.0676, 0.02, 5e-4, -5e-4, 0.001};
  for (double x = 0; x <= 4104; x += 513) {
    for (double y = 0; y <= 1012; y += 253) {
      const IdealPoint ideal = camera.undistort({x, y});
      const ImagePoint seen = camera.distort(ideal);
      EXPECT_NEAR(seen.x, x, 1e-9);
      EXPECT_NEAR(seen.y, y, 1e-9);
    }
  }
}

// r (1 + k1 r^2) folds at r^2 = -1 / (3 k1), where the seen radius is 2/3 of r.
TEST(Camera, ABarrelFoldsWhereItsSlopeVanishes) {
  const Camera strong{.width = 1601, .height = 1201, .fx = 1000.0, .fy = 1000.0, .cx = 800.0, .cy = 600.0, .k1 = -0.3};
  ASSERT_TRUE(strong.fold_px());
  EXPECT_NEAR(*strong.fold_px(), 2.0 / 3.0 * std::sqrt(1.0 / 0.9) * 1000.0, 1.0);
  Camera weak = strong;
  weak.k1 = -0.1;  // fold at 1217 px, corner at 1000 px
  EXPECT_FALSE(weak.fold_px());
  weak.k1 = 0.3;
  EXPECT_FALSE(weak.fold_px());
}

TEST(Camera, TheLensesOfTheRigAreNamedByTheirDistortionAtTheSensorsCorner) {
  Camera camera{4104, 1012, 3478.26, 3478.26, 2059.3, 494.3};
  camera.k1 = -0.0225;
  const ImagePoint seen = camera.distort({2059.3 + 2317.0, 494.3});
  EXPECT_NEAR((seen.x - 2059.3) / 2317.0 - 1.0, -0.01, 5e-5);  // -1 %, to the three digits of k1
}

// Three points determine the pose of a known camera, starting from a pose near it as in a previous frame.
TEST(Pose, FollowsFromThreePointsWithAKnownCamera) {
  Camera camera;
  camera.fx = camera.fy = 3000.0, camera.cx = 1000.0, camera.cy = 500.0;
  const Pose before{{0.02, -0.10, 0.05}, {-12.0, 5.0, 1200.0}}, now{{0.05, -0.13, 0.04}, {-30.0, 9.0, 1230.0}};
  const std::array<BoardPoint, 3> board{{{-100, 40}, {100, 40}, {-100, -40}}};
  std::array<IdealPoint, 3> seen;
  for (std::size_t i = 0; i < 3; ++i) seen[i] = view_of(now, camera)(board[i]);
  const auto view = view_of_three(board, seen, camera, view_of(before, camera));
  ASSERT_TRUE(view);
  const BoardPoint fourth{100, -40};  // 1e-9 px at three points, extrapolated by a factor below ten
  EXPECT_LT(length((*view)(fourth)-view_of(now, camera)(fourth)), 1e-8);
  const Pose again = pose_of(*view, camera);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(again.turn[k], now.turn[k], 1e-10);
}

TEST(Pose, DoesNotFollowFromThreePointsOnALine) {
  Camera camera;
  camera.fx = camera.fy = 3000.0;
  const Pose pose{{0.02, -0.10, 0.05}, {-12.0, 5.0, 1200.0}};
  const std::array<BoardPoint, 3> board{{{-100, 0}, {0, 0}, {100, 0}}};
  std::array<IdealPoint, 3> seen;
  for (std::size_t i = 0; i < 3; ++i)
    seen[i] = view_of(pose, camera)(board[i]) + Extent<frame::Ideal>{0.5, i == 1 ? 0.2 : 0.0};
  EXPECT_FALSE(view_of_three(board, seen, camera, view_of(pose, camera)));
}

}  // namespace
}  // namespace moiregauge::internal
