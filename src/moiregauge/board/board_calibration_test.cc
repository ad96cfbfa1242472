// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/board/board_calibration.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "moiregauge/board/board_bundle.h"
#include "moiregauge/board/board_places.h"
#include "moiregauge/geometry/pose.h"
#include "moiregauge/geometry/view.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr double kStep = 14.0;  // mm
constexpr double kNoise_px = 0.05;
constexpr int kColumns = 8, kRows = 6;
constexpr std::uint64_t kBoardSeed = 5;

const Camera kCamera{1600, 1200, 1800.0, 1800.0, 815.0, 590.0, -0.2, 0.05, 0.0006, -0.0004, 0.0};

struct Look {
  double tilt_x, tilt_y, turn;  // deg
};
// Five tilts to different sides, and one view that faces the board.
const std::vector<Look> kLooks{{30, 0, 3}, {-28, 10, -5}, {4, 35, 2}, {-6, -32, 8}, {25, 25, -3}, {1, -2, 1}};

IdealFromBoard seen_by(const Look& look) {
  using Eigen::AngleAxisd, Eigen::Vector3d;
  const double deg = kPi / 180.0;
  const Eigen::Matrix3d r =
      (AngleAxisd(look.tilt_x * deg, Vector3d::UnitX()) * AngleAxisd(look.tilt_y * deg, Vector3d::UnitY()) *
       AngleAxisd(look.turn * deg, Vector3d::UnitZ()))
          .toRotationMatrix();
  Eigen::Matrix3d k, h;
  k << kCamera.fx, 0, kCamera.cx, 0, kCamera.fy, kCamera.cy, 0, 0, 1;
  h << r.col(0), -r.col(1), Vector3d(0.4 * look.tilt_y, -0.3 * look.tilt_x, 175.0);
  return IdealFromBoard(k * h);
}

using Errors = std::vector<Extent<frame::Board>>;  // print errors, row by row; empty: none

// Each view numbers columns and rows from its own left and top, `quarters` of a turn away from the board's.
BoardView view_of(const Look& look, const Errors& print, int quarters, std::mt19937_64& rng) {
  std::normal_distribution<double> noise(0.0, kNoise_px);
  const View view{seen_by(look), kCamera};
  BoardView out{kCamera.width, kCamera.height, {}};
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const auto n = static_cast<std::size_t>(row * kColumns + column);
      const BoardPoint at{kStep * (column - 0.5 * (kColumns - 1)), kStep * (0.5 * (kRows - 1) - row)};
      const ImagePoint seen = view(print.empty() ? at : at + print[n]);
      BoardPointSeen p{at, {seen.x + noise(rng), seen.y + noise(rng)}, kNoise_px, 0.0, column, row};
      for (int k = 0; k < quarters; ++k) {
        p.board = {-p.board.y, p.board.x};
        const int last = k % 2 == 0 ? kColumns - 1 : kRows - 1, c = p.column;
        p.column = p.row;
        p.row = last - c;
      }
      out.points.push_back(p);
    }
  }
  return out;
}

std::vector<BoardView> views_of(const std::vector<Look>& looks, const Errors& print) {
  std::mt19937_64 rng(kBoardSeed);
  std::vector<BoardView> views;
  for (std::size_t v = 0; v < looks.size(); ++v)
    views.push_back(view_of(looks[v], print, static_cast<int>(v % 4), rng));
  return views;
}

// Returns the centre of the ellipse nearest to the image of a circle (least-squares conic through points of the
// outline).
ImagePoint outline_centre(const View& view, BoardPoint centre, double radius) {
  constexpr int kPoints = 360;
  const ImagePoint middle = view(centre);
  Eigen::Matrix<double, kPoints, 5> a;
  for (int k = 0; k < kPoints; ++k) {
    const double angle = kTwoPi * k / kPoints;
    const auto q = view(centre + Extent<frame::Board>{radius * std::cos(angle), radius * std::sin(angle)}) - middle;
    a.row(k) << q.x * q.x, q.x * q.y, q.y * q.y, q.x, q.y;
  }
  const Eigen::Matrix<double, 5, 1> c = a.colPivHouseholderQr().solve(Eigen::Matrix<double, kPoints, 1>::Ones());
  Eigen::Matrix2d m;
  m << 2.0 * c(0), c(1), c(1), 2.0 * c(2);
  const Eigen::Vector2d off = m.inverse() * Eigen::Vector2d(-c(3), -c(4));
  return {middle.x + off.x(), middle.y + off.y()};
}

Errors bad_print(double u_mm) {
  std::mt19937_64 rng(kBoardSeed + 1);
  std::normal_distribution<double> error(0.0, u_mm);
  Errors out;
  for (int i = 0; i < kColumns * kRows; ++i) {
    const double x = error(rng);
    out.push_back({x, error(rng)});
  }
  return out;
}

void expect_the_camera(const BoardCalibration& s) {
  const Camera& c = s.camera;
  const double off[]{c.fx - kCamera.fx, c.cx - kCamera.cx, c.cy - kCamera.cy, c.k1 - kCamera.k1,
                     c.k2 - kCamera.k2, c.p1 - kCamera.p1, c.p2 - kCamera.p2};
  for (std::size_t k = 0; k < 7; ++k)
    EXPECT_LE(std::abs(off[k]), 3.0 * s.u[k]) << "parameter " << k << ", seed " << kBoardSeed;
}

TEST(CalibrateBoard, FindsTheCameraWithinItsUncertainty) {
  const auto solved = calibrate_board(views_of(kLooks, {}), {});
  ASSERT_TRUE(solved) << solved.error();
  expect_the_camera(*solved);
  EXPECT_LT(solved->u[0], 2.0) << "of 1800 px";
  // 6 views of 48 points, minus 6 poses and 7 parameters: 533 degrees of freedom.
  EXPECT_NEAR(solved->chi2_dof, 1.0, 4.0 * std::sqrt(2.0 / 533.0)) << "seed " << kBoardSeed;
  EXPECT_LE(solved->print_mm, 1e-3);
  // With the lens removed a homography leaves only noise: sqrt 2 of it in length, less eight of 96 numbers.
  for (const CalibratedView& v : solved->views) {
    EXPECT_GT(v.null.lattice_seen, 5.0 * v.null.lattice);
    EXPECT_NEAR(v.null.lattice, std::sqrt(2.0 * (1.0 - 8.0 / 96.0)) * kNoise_px, 0.02);
  }
}

// 20 um of print error are 0.2 px, four times the noise. They are the same in every view, whatever its numbering.
TEST(CalibrateBoard, SeparatesPrintErrorsFromTheLens) {
  const auto solved = calibrate_board(views_of(kLooks, bad_print(0.02)), {});
  ASSERT_TRUE(solved) << solved.error();
  EXPECT_EQ(solved->matched, 6);
  EXPECT_NEAR(solved->print_mm, 0.02, 0.005);
  EXPECT_LE(solved->point_px, 0.5 * kNoise_px) << "beyond the points' own noise";
  expect_the_camera(*solved);
}

TEST(CalibrateBoard, NearlyParallelViewsLeaveTheFocalLengthUncertain) {
  const auto open = calibrate_board(views_of({{1, 0, 0}, {0, 2, 5}}, {}), {});
  const auto determined = calibrate_board(views_of({{30, 0, 0}, {0, 30, 5}}, {}), {});
  ASSERT_TRUE(open) << open.error();
  ASSERT_TRUE(determined) << determined.error();
  EXPECT_GT(open->u[0], 20.0 * determined->u[0]);
  EXPECT_LE(std::abs(open->camera.fx - kCamera.fx), 3.0 * open->u[0]) << "seed " << kBoardSeed;
}

// Ten points of one view, each 2 px off in a direction of its own: 40 times their noise.
TEST(CalibrateBoard, MisreadPointsAreLeftOut) {
  auto views = views_of(kLooks, {});
  for (int n = 0; n < 10; ++n) {
    ImagePoint& at = views[2].points[static_cast<std::size_t>(4 * n)].at;
    at = {at.x + 2.0 * std::cos(1.3 * n), at.y + 2.0 * std::sin(1.3 * n)};
  }
  const auto solved = calibrate_board(views, {});
  ASSERT_TRUE(solved) << solved.error();
  expect_the_camera(*solved);
  EXPECT_NEAR(solved->chi2_dof, 1.0, 4.0 * std::sqrt(2.0 / 513.0)) << "seed " << kBoardSeed;
}

// Ten points of one view are 10 px too far right: 200 times their noise. Each counts by its distance, as one at 28 u
// would in a sum of squares. Squared, they would move the camera by ten u and more.
TEST(SolveBoard, MisreadPointsHardlyMoveTheCamera) {
  std::mt19937_64 rng(kBoardSeed);
  BoardData data;
  BoardState start;
  const BoardPrior prior = board_prior(kCamera.width, kCamera.height, kCamera.fx);
  start.camera = prior.mean;
  for (const Look& look : kLooks) {
    data.views.push_back(view_of(look, {}, 0, rng).points);
    data.u_px.emplace_back(data.views.back().size(), kNoise_px);
    data.place.emplace_back(data.views.back().size(), kNoPlace);
    start.poses.push_back(pose_of(seen_by(look), kCamera));
  }
  for (std::size_t n = 0; n < 10; ++n) data.views[2][4 * n].at.x += 10.0;
  const BoardModel model{.radial = true, .tangential = true};
  const BoardState solved = solve_board(data, prior, model, start);
  ASSERT_TRUE(solved.solved);
  const CameraBlock u = uncertainty_of(data, prior, model, solved, 0.0);
  const double off[]{solved.camera[0] - kCamera.fx, solved.camera[1] - kCamera.cx, solved.camera[2] - kCamera.cy};
  for (std::size_t k = 0; k < 3; ++k) EXPECT_LT(std::abs(off[k]), 4.0 * u[k]) << k << ", seed " << kBoardSeed;
}

// The board is wavy in one view, by a millimetre: 6 px where the camera sees it from the side.
TEST(CalibrateBoard, ExcludesAViewInWhichTheBoardIsBent) {
  auto views = views_of(kLooks, {});
  for (BoardPointSeen& p : views[2].points) p.at.x += 6.0 * std::cos(kPi * p.board.x / 28.0);
  const auto solved = calibrate_board(views, {});
  ASSERT_TRUE(solved) << solved.error();
  EXPECT_FALSE(solved->views[2].excluded.empty());
  expect_the_camera(*solved);
}

TEST(CalibrateBoard, ExcludesViewsOfAnotherCameraOrBoard) {
  auto views = views_of(kLooks, {});
  views[1].width = 1280;
  for (std::size_t i = 0; i < 3 * kColumns; ++i) views[3].points[i].board.x += kStep;  // an error of the indexing
  const auto solved = calibrate_board(views, {});
  ASSERT_TRUE(solved) << solved.error();
  for (std::size_t v = 0; v < views.size(); ++v) EXPECT_EQ(solved->views[v].excluded.empty(), v != 1 && v != 3) << v;
  EXPECT_NE(solved->views[1].excluded.find("1280 x 1200 px"), std::string::npos);
  expect_the_camera(*solved);
}

// A camera with another zoom is another camera.
TEST(CalibrateBoard, ViewsOfAnotherZoomAreNamed) {
  auto views = views_of(kLooks, {});
  const auto one = calibrate_board(views, {});
  ASSERT_TRUE(one) << one.error();
  // 96 coordinates, minus 13 or 6 parameters: the ratio of two such scatters is within 0.2 of 1.
  for (const CalibratedView& view : one->views) EXPECT_NEAR(view.misfit_ratio, 1.0, 0.2);
  for (std::size_t v = 0; v < 3; ++v) {
    for (BoardPointSeen& p : views[v].points)
      p.at = {kCamera.cx + 1.3 * (p.at.x - kCamera.cx), kCamera.cy + 1.3 * (p.at.y - kCamera.cy)};
  }
  const auto mixed = calibrate_board(views, {});
  ASSERT_TRUE(mixed) << mixed.error();
  int named = 0;  // excluded as another board, or named by its misfit
  for (const CalibratedView& view : mixed->views) named += !view.excluded.empty() || view.misfit_ratio > 3.0 ? 1 : 0;
  EXPECT_GE(named, 3);
}

TEST(CalibrateBoard, RefusesWhenNothingShowsABoard) {
  EXPECT_FALSE(calibrate_board({}, {}));
  EXPECT_FALSE(calibrate_board(std::vector<BoardView>{{1600, 1200, {}}}, {}));
}

// Dots of 7 mm are 72 px wide. Seen at 30 deg, the centres of their outlines are up to 0.2 px from the images of their
// centres.
TEST(CalibrateBoard, CorrectsTheCentresOfDots) {
  std::mt19937_64 rng(kBoardSeed);
  std::vector<BoardView> views;
  for (const Look& look : {kLooks[0], kLooks[1], kLooks[2], kLooks[3]}) {
    const View view{seen_by(look), kCamera};
    views.push_back(view_of(look, {}, 0, rng));
    for (BoardPointSeen& p : views.back().points) {
      p.at = outline_centre(view, p.board, 3.5);
      p.u_px = 0.003;
      p.diameter_mm = 7.0;
    }
  }
  const auto as_circles = calibrate_board(views, {});
  for (BoardView& view : views) {
    for (BoardPointSeen& p : view.points) p.diameter_mm = 0.0;
  }
  const auto as_points = calibrate_board(views, {});
  ASSERT_TRUE(as_circles && as_points);
  EXPECT_LE(as_circles->rms_px, 0.01);
  EXPECT_NEAR(as_circles->camera.fx, kCamera.fx, 0.05);
  EXPECT_GE(std::abs(as_points->camera.fx - kCamera.fx), 0.2);
}

TEST(MatchPlaces, IdentifiesARotatedPartOfAPrint) {
  std::mt19937_64 rng(kBoardSeed);
  std::normal_distribution<double> normal;
  std::vector<PlacedPoint> whole, part;
  for (int y = 0; y < 12; ++y) {
    for (int x = 0; x < 14; ++x) {
      const PlacedPoint p{x, y, {normal(rng), normal(rng)}};
      whole.push_back(p);
      // Rotated by a quarter turn, without three columns.
      if (x >= 3) part.push_back({-y + 40, x - 3, {-p.off.y() + 0.3 * normal(rng), p.off.x() + 0.3 * normal(rng)}});
    }
  }
  const auto cells = match_places({whole, part});
  ASSERT_EQ(cells[1].cells.size(), part.size());
  EXPECT_EQ(cells[1].turns, 3);
  for (std::size_t i = 0; i < part.size(); ++i) {
    EXPECT_EQ(cells[1].cells[i].first, part[i].y + 3);
    EXPECT_EQ(cells[1].cells[i].second, 40 - part[i].x);
  }
}

TEST(MatchPlaces, NoiseDoesNotMatch) {
  std::mt19937_64 rng(kBoardSeed);
  std::normal_distribution<double> normal;
  std::vector<std::vector<PlacedPoint>> views(5);
  for (auto& view : views) {
    for (int i = 0; i < 120; ++i) view.push_back({i % 12, i / 12, {normal(rng), normal(rng)}});
  }
  for (const auto& view : match_places(views)) EXPECT_TRUE(view.cells.empty());
}

}  // namespace
}  // namespace moiregauge::internal
