// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/reference/site_check.h"

#include <array>
#include <cmath>
#include <string>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "moiregauge/observation/reference/grating_lens.h"
#include "moiregauge/observation/reference/reference.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

// Four references on the corners of 400 mm x 200 mm, whose circles are known to `u_mm`. The gratings show that their
// pitches are `stretch` larger than the circles' spacing gives.
Reference board_known_to(double u_mm, double stretch, std::size_t stretched) {
  Reference reference;
  reference.site.known_to.position_mm = u_mm;
  Matrix3 h;
  h << 3, 0, 700, 0, -3, 400, 0, 0, 1;
  reference.view = {IdealFromBoard(h), {}};
  for (const BoardPoint at : {BoardPoint{-200, 100}, {200, 100}, {-200, -100}, {200, -100}}) {
    Marker marker;
    marker.name = std::to_string(reference.site.markers.size());
    marker.circle = Circle{at, 0.0};
    marker.grating = Grating{at, 40.0, 40.0, 10.0, 0.0, Pattern::kGrid};
    const double own = stretched == 4 || stretched == reference.site.markers.size() ? stretch : 0.0;
    MarkerObservation seen;
    seen.patch.valid = true;
    seen.patch.gradient = {{{own, 0.0}, {0.0, own}}};
    seen.patch.u_gradient = 1e-4;
    reference.circles.push_back({reference.site.markers.size(), at, {}, 0.03});
    reference.site.markers.push_back(marker);
    reference.plans.emplace_back();
    reference.seen.markers.push_back(seen);
  }
  return reference;
}

// Two circles known to u and 200 mm apart give the scale to sqrt(2) u / 200 mm. Perspective adds a third of that. For a
// u of 3 mm the sum is 2.8 %. A pitch may then be wrong by 6 %. One wrong by 9.5 % contradicts the circles.
TEST(SiteCheck, APitchMustAgreeWithinThreeUncertaintiesOfTheCircles) {
  EXPECT_FALSE(site_disagreement(board_known_to(3.0, 0.06, 1)));
  EXPECT_TRUE(site_disagreement(board_known_to(3.0, 0.095, 1)));
}

// The mean of all four is known to 0.5 u / 200 mm and 0.5 u / 400 mm along the axes: 0.84 % for 3 mm.
TEST(SiteCheck, ACommonPitchMustAgreeWithinThreeUncertaintiesOfTheMeanScale) {
  EXPECT_FALSE(site_disagreement(board_known_to(3.0, 0.022, 4)));
  EXPECT_TRUE(site_disagreement(board_known_to(3.0, 0.035, 4)));
}

// Circles of 20 mm at 3 px/mm: 60 px. A tone curve moves all edges alike, a wrong diameter is that of one marker.
Reference circles_larger_by(std::array<double, 4> px) {
  Reference reference = board_known_to(0.1, 0.0, 0);
  for (std::size_t i = 0; i < px.size(); ++i) {
    reference.site.markers[i].circle->diameter_mm = 20.0;
    reference.seen.markers[i].circle.emplace().diameter_px = 60.0 + px[i];
  }
  return reference;
}

TEST(SiteCheck, CirclesThatAllLookTooSmallHintAtTheToneCurve) {
  const auto all = site_disagreement(circles_larger_by({-1.5, -1.4, -1.6, -1.5}));
  ASSERT_TRUE(all);
  EXPECT_NE(all->find("All circles look too small by about the same number of pixels"), std::string::npos) << *all;
  for (const auto& others : {std::array{-1.5, 0.1, 0.0, -0.1}, {-1.5, -1.4, 1.6, -1.5}, {-6.0, -6.0, -6.0, -6.0}}) {
    const auto text = site_disagreement(circles_larger_by(others));
    ASSERT_TRUE(text);
    EXPECT_EQ(text->find("--tone"), std::string::npos) << *text;
  }
}

// A layout of 1000 x 560 px in an image of 1280 x 720 px, with targets in the middle and at its lower edge. The lens
// displaces a point at the corner of the image by `distortion` of half the diagonal. All gratings are `larger` than
// stated. A grating at X is seen at S(X), and the raster reads it by a map without a lens, as S^-1 would be. The axes of
// the raster are rotated by `raster_rad`.
Reference behind_lens(double distortion, double larger, double raster_rad = 0.0) {
  const double f = 0.5 * std::hypot(1280.0, 720.0);
  const auto seen_at = [&](BoardPoint p) {  // 0.5 mm per px
    const double x = 2.0 * p.x / f, y = -2.0 * p.y / f, radial = 1.0 + distortion * (x * x + y * y);
    return ImagePoint{639.5 + f * x * radial, 359.5 + f * y * radial};
  };
  Reference reference;
  reference.width = 1280, reference.height = 720;
  reference.site.known_to.position_mm = 1.0;
  for (const BoardPoint at : {BoardPoint{-250, 140}, {250, 140}, {-250, -140}, {250, -140}, {0, 0}, {20, -130}}) {
    const std::size_t i = reference.site.markers.size();
    Marker marker;
    marker.name = std::to_string(i);
    marker.role = i < 4 ? Role::kReference : Role::kTarget;
    marker.grating = Grating{at, 40.0, 40.0, 10.0, 0.0, Pattern::kGrid};
    if (i < 4) {
      marker.circle = Circle{at, 0.0};
      const ImagePoint seen = seen_at(at);
      reference.circles.push_back({i, at, {seen.x, seen.y}, 0.03});
    }
    reference.site.markers.push_back(marker);
  }
  reference.view = {fit_circles(reference.circles).value(), {}};
  for (const Marker& marker : reference.site.markers) {
    const BoardPoint at = marker.grating->centre;
    const auto read_at = [&](Extent<frame::Board> d) { return reference.view.board(seen_at(at + (1.0 + larger) * d)); };
    const auto by_x = read_at({1e-3, 0}) - read_at({-1e-3, 0}), by_y = read_at({0, 1e-3}) - read_at({0, -1e-3});
    Matrix2 magnified;
    magnified << by_x.x, by_y.x, by_x.y, by_y.y;
    const Matrix2 axes = Eigen::Rotation2Dd(raster_rad).toRotationMatrix();
    const Matrix2 gradient = axes.transpose() * (Matrix2::Identity() - (magnified / 2e-3).inverse()) * axes;
    MarkerObservation seen;
    seen.patch.valid = true;
    seen.patch.gradient = {{{gradient(0, 0), gradient(0, 1)}, {gradient(1, 0), gradient(1, 1)}}};
    seen.patch.u_gradient = 1e-4;
    reference.plans.emplace_back().angle_rad = raster_rad;
    reference.seen.markers.push_back(seen);
  }
  return reference;
}

// The radial sizes at the corners differ from those across by 2 k r^2, 10 % for a lens of 8 %.
TEST(SiteCheck, ALensIsNoWrongPitch) {
  for (const double raster_rad : {0.0, kPi / 4.0}) {  // a checkerboard is read along its diagonals
    for (const double distortion : {-0.08, -0.05, 0.05, 0.08}) {
      const Reference reference = behind_lens(distortion, 0.0, raster_rad);
      const auto text = site_disagreement(reference);
      EXPECT_FALSE(text) << *text << ", distortion " << distortion << ", raster " << raster_rad;
      const auto lens = lens_from_gratings(reference, 0.005);
      ASSERT_TRUE(lens);
      EXPECT_NEAR(lens->view.lens.k1, distortion, 1e-4) << "no noise, and the Gauss-Newton steps have converged";
    }
  }
}

// Without a lens none is found, and a lens does not hide that all gratings are 4 % too large.
TEST(SiteCheck, AWrongPitchIsNoLens) {
  EXPECT_FALSE(lens_from_gratings(behind_lens(0.0, 0.04), 0.005));
  for (const double distortion : {-0.05, 0.0, 0.05}) {
    const auto text = site_disagreement(behind_lens(distortion, 0.04));
    ASSERT_TRUE(text) << "distortion " << distortion;
    EXPECT_NE(text->find("which gives 10.38 mm"), std::string::npos) << *text;  // 1 + (1 - 1 / 1.04)
  }
}

}  // namespace
}  // namespace moiregauge::internal
