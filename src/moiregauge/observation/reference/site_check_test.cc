// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/reference/site_check.h"

#include <array>
#include <string>

#include <gtest/gtest.h>

#include "moiregauge/observation/reference/reference.h"

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

}  // namespace
}  // namespace moiregauge::internal
