// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/identity/identify_markers.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

using ImageFromBoard = Homography<frame::Image, frame::Board>;
constexpr std::uint64_t kIdentitySeed = 7;
constexpr double kCircleMm = 20.0;

Site flat_site(double half_width_mm, double half_height_mm) {
  Site site;
  for (const double y : {1.0, -1.0}) {
    for (const double x : {-1.0, 1.0}) {
      Marker marker;
      marker.circle = Circle{{x * half_width_mm, y * half_height_mm}, kCircleMm};
      site.markers.push_back(marker);
    }
  }
  return site;
}

// Returns the view of a camera with a focal length of 4000 px; angles in degrees.
ImageFromBoard oblique_view(double pitch, double yaw, double roll, double distance_mm) {
  const Eigen::Matrix3d turn = (Eigen::AngleAxisd(radians_from_degrees(pitch), Eigen::Vector3d::UnitX()) *
                                Eigen::AngleAxisd(radians_from_degrees(yaw), Eigen::Vector3d::UnitY()) *
                                Eigen::AngleAxisd(radians_from_degrees(roll), Eigen::Vector3d::UnitZ()))
                                   .toRotationMatrix();
  const Eigen::Matrix3d camera = (Eigen::Matrix3d() << 4000, 0, 2050, 0, 4000, 1000, 0, 0, 1).finished();
  const Eigen::Matrix3d up_is_up = Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
  Eigen::Matrix3d plane = up_is_up * turn;
  plane.col(2) = Eigen::Vector3d(0.0, 0.0, distance_mm);
  return ImageFromBoard(camera * plane);
}

DetectedCircle seen_circle(const ImageFromBoard& view, BoardPoint where, double diameter_mm) {
  const Matrix2 j = view.jacobian(where);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(j * j.transpose());
  DetectedCircle circle;
  circle.centre = view(where);
  circle.diameter_px = diameter_mm * std::sqrt(std::abs(j.determinant()));
  circle.axis_ratio = std::sqrt(solver.eigenvalues()[0] / solver.eigenvalues()[1]);
  circle.angle_rad = std::atan2(solver.eigenvectors()(1, 1), solver.eigenvectors()(0, 1));
  return circle;
}

CircleSearch seen_in(const ImageFromBoard& view, const Site& site) {
  CircleSearch search;
  for (const Marker& marker : site.markers)
    search.circles.push_back(seen_circle(view, marker.circle->centre, kCircleMm));
  return search;
}

const std::vector<int> kInOrder{0, 1, 2, 3};

TEST(Identity, IsRightOrRefusedAmongFalseCandidatesAndEllipses) {
  std::mt19937_64 rng(kIdentitySeed);
  std::uniform_real_distribution<double> share(-0.5, 0.5);
  int right = 0;
  constexpr int kScenes = 300;
  for (int k = 0; k < kScenes; ++k) {
    const Site site = k % 2 == 0 ? flat_site(525, 45) : flat_site(100, 60);
    const ImageFromBoard view =
        oblique_view(40 * share(rng), 40 * share(rng), 60 * share(rng), k % 2 == 0 ? 1500 : 900);
    CircleSearch search = seen_in(view, site);
    for (int i = 0; i < 10; ++i) {
      const BoardPoint there{2.2 * share(rng) * site.markers[1].circle->centre.x,
                             3.0 * share(rng) * site.markers[1].circle->centre.y};
      bool free = true;
      for (const Marker& marker : site.markers) free = free && length(there - marker.circle->centre) > 1.1 * kCircleMm;
      if (!free) continue;
      DetectedCircle decoy = seen_circle(view, there, i < 6 ? kCircleMm : kCircleMm * (1.0 + share(rng)));
      if (i >= 6) decoy.axis_ratio *= 0.85 + 0.3 * share(rng);
      search.circles.push_back(decoy);
    }
    const auto who = identify_first(site, search);
    if (!who) continue;
    ++right;
    EXPECT_EQ(who->circle_of_marker, kInOrder) << "seed " << kIdentitySeed << " scene " << k;
  }
  EXPECT_GT(right, 0.95 * kScenes);
}

TEST(Identity, AMirrorImageIsNotTheBoard) {
  Site site = flat_site(200, 60);
  site.markers[0].circle->centre.x = -150;  // removes all symmetries
  ImageFromBoard view = oblique_view(5, -10, 8, 1500);
  const Matrix3 flip = Eigen::Vector3d(-1.0, 1.0, 1.0).asDiagonal();
  EXPECT_FALSE(identify_first(site, seen_in(ImageFromBoard(flip * view.matrix()), site)));
  EXPECT_TRUE(identify_first(site, seen_in(view, site)));
}

TEST(Identity, ARectangleIsIdentifiedInTheRotationNearestToUpright) {
  const Site site = flat_site(100, 100);
  const auto who = identify_first(site, seen_in(oblique_view(0, 0, 35, 900), site));
  ASSERT_TRUE(who);
  EXPECT_EQ(who->circle_of_marker, kInOrder);
  const auto no_telling = identify_first(site, seen_in(oblique_view(0, 0, 45, 900), site));
  ASSERT_FALSE(no_telling);
  EXPECT_NE(no_telling.error().reason.find("equally close to upright"), std::string::npos);
}

TEST(Identity, LaterFramesFollowTheBoardBeyondARotationOf45Degrees) {
  const Site site = flat_site(100, 100);
  PreviousCircles previous{oblique_view(0, 0, 40, 900), 0.0};
  const auto who = identify_next(site, seen_in(oblique_view(0, 0, 52, 900), site), previous);
  ASSERT_TRUE(who);
  EXPECT_EQ(who->circle_of_marker, kInOrder);
}

TEST(Identity, ASecondSetThatFitsEquallyWellIsRefused) {
  const Site site = flat_site(100, 60);
  const ImageFromBoard view = oblique_view(0, 0, 0, 1500);
  CircleSearch search = seen_in(view, site);
  for (const Marker& marker : site.markers) {
    search.circles.push_back(seen_circle(view, {marker.circle->centre.x, marker.circle->centre.y + 200.0}, kCircleMm));
  }
  const auto who = identify_first(site, search);
  ASSERT_FALSE(who);
  EXPECT_NE(who.error().reason.find("equally well"), std::string::npos);
  const auto later = identify_next(site, search, {view, 50.0});
  ASSERT_TRUE(later);
  EXPECT_EQ(later->circle_of_marker, kInOrder);
}

TEST(Identity, AMissingReferenceIsReportedWithTheBestRejectedOutline) {
  const Site site = flat_site(100, 60);
  CircleSearch search = seen_in(oblique_view(0, 0, 0, 1500), site);
  search.circles.pop_back();
  search.rejected.push_back({{2317, 1160}, 53.0, 0.81, "not round enough, W = 0.81 of at least 0.84"});
  const auto who = identify_first(site, search);
  ASSERT_FALSE(who);
  EXPECT_EQ(who.error().found, 3);
  EXPECT_EQ(
      who.error().reason,
      "only 3 of 4 reference circles were found (best rejected outline not round enough, W = 0.81 of at least 0.84)");
}

TEST(Identity, AFifthReferenceMayBeHidden) {
  Site site = flat_site(200, 60);
  Marker fifth;
  fifth.circle = Circle{{30, 60}, kCircleMm};
  site.markers.push_back(fifth);
  CircleSearch search = seen_in(oblique_view(5, 10, 3, 1500), site);
  const auto all = identify_first(site, search);
  ASSERT_TRUE(all);
  EXPECT_EQ(all->circle_of_marker, (std::vector<int>{0, 1, 2, 3, 4}));
  search.circles.erase(search.circles.begin() + 1);
  const auto four = identify_first(site, search);
  ASSERT_TRUE(four) << four.error().reason;
  EXPECT_EQ(four->circle_of_marker, (std::vector<int>{0, -1, 1, 2, 3}));
}

}  // namespace
}  // namespace moiregauge::internal
