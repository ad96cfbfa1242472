// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/sheet/set_layout.h"

#include <cmath>

#include <gtest/gtest.h>

#include "moiregauge/detection/identity/layout_symmetry.h"

namespace moiregauge::internal::sheet {
namespace {

SetRequest rig() {
  SetRequest request;
  request.span = {760.0, 56.0};
  return request;
}

const Marker& named(const Site& site, const std::string& name) {
  for (const Marker& marker : site.markers) {
    if (marker.name == name) return marker;
  }
  ADD_FAILURE() << "no marker " << name;
  return site.markers.front();
}

// The rig of docs/cli/simulate.md: circles of 20 mm at (+-380, +-28), gratings of 40 mm at (+-340, +-28), target of 60
// mm.
TEST(SetLayout, TheSpanOfTheRigGivesTheRig) {
  const auto site = site_of_set(rig());
  ASSERT_TRUE(site) << site.error();
  ASSERT_EQ(site->markers.size(), 5u);
  const Marker& nw = named(*site, "NW");
  EXPECT_EQ(nw.circle->centre.x, -380.0);
  EXPECT_EQ(nw.circle->centre.y, 28.0);
  EXPECT_EQ(nw.circle->diameter_mm, 25.0);  // the marked circle
  EXPECT_EQ(named(*site, "SE").circle->diameter_mm, 20.0);
  EXPECT_EQ(nw.grating->centre.x, -340.0);
  EXPECT_EQ(nw.grating->width_mm, 40.0);
  EXPECT_EQ(named(*site, "SE").grating->centre.x, 340.0);
  EXPECT_EQ(named(*site, "T1").grating->centre.x, 0.0);
  EXPECT_EQ(named(*site, "T1").grating->height_mm, 60.0);
}

TEST(SetLayout, NoMirrorImageAndNoHalfTurnOfASheetsLayoutLooksLikeIt) {
  for (const int references : {4, 6}) {
    SetRequest request = rig();
    request.references = references;
    const auto site = site_of_set(request);
    ASSERT_TRUE(site) << site.error();
    EXPECT_FALSE(symmetry_note(*site)) << *symmetry_note(*site);
  }
}

// Detection needs this gap for any span, also if the two middle references are shifted.
TEST(SetLayout, NoTwoMarkersAreNearerThanAPitch) {
  for (const int references : {4, 6}) {
    for (const double height : {56.0, 120.0, 300.0, 500.0}) {
      SetRequest request = rig();
      request.references = references;
      request.span.y = height;
      const auto site = site_of_set(request);
      ASSERT_TRUE(site) << site.error();
      for (std::size_t i = 0; i < site->markers.size(); ++i) {
        for (std::size_t k = i + 1; k < site->markers.size(); ++k)
          EXPECT_GE(gap_between(extent_of(site->markers[i]), extent_of(site->markers[k])), 10.0 - 1e-9)
              << references << " references, " << height << " mm: " << i << " and " << k;
      }
    }
  }
}

TEST(SetLayout, TargetsThatDoNotFitBetweenTheReferencesAreRefusedByName) {
  SetRequest request = rig();
  request.targets = 12;
  const auto site = site_of_set(request);
  ASSERT_FALSE(site);
  EXPECT_NE(site.error().find("'NW' and 'T1'"), std::string::npos) << site.error();
}

TEST(SetLayout, LinesAreForTargetsBecauseReferencesMustShowBothAxes) {
  SetRequest request = rig();
  request.pattern = Pattern::kLinesY;
  const auto site = site_of_set(request);
  ASSERT_TRUE(site);
  EXPECT_EQ(named(*site, "NE").grating->pattern, Pattern::kGrid);
  EXPECT_EQ(named(*site, "T1").grating->pattern, Pattern::kLinesY);
}

TEST(SetLayout, TheWidestSpanFillsTheAvailableArea) {
  constexpr double kWhite_mm = 12.5;  // radius of the larger circle
  SetRequest request = rig();
  const Extent<frame::Board> room{394.0, 258.0};
  request.span = widest_span(request, room);
  const auto site = site_of_set(request);
  ASSERT_TRUE(site) << site.error();
  const Box box = extent_of(site->markers);
  EXPECT_LE(box.width() + 2.0 * kWhite_mm, room.x);
  EXPECT_LE(box.height() + 2.0 * kWhite_mm, room.y);
  EXPECT_GT(box.width() + 2.0 * kWhite_mm, room.x - 10.0);  // spans are whole centimetres
  EXPECT_GT(box.height() + 2.0 * kWhite_mm, room.y - 10.0);
}

TEST(SetLayout, TheFittingPitchIsTheLargestThatFits) {
  SetRequest request;
  request.references = 6;
  const Extent<frame::Board> room{271.0, 171.0};  // a page of A4
  const auto fits = [&](double pitch) {
    SetRequest other = request;
    other.pitch_mm = pitch;
    other.span = widest_span(other, room);
    return site_of_set(other).has_value();
  };
  ASSERT_FALSE(fits(10.0));
  const auto pitch = fitting_pitch(request, room);
  ASSERT_TRUE(pitch);
  EXPECT_TRUE(fits(*pitch));
  for (double larger = *pitch + 0.5; larger < 10.0; larger += 0.5) EXPECT_FALSE(fits(larger)) << larger;
  request.target_size_mm = 300.0;  // larger than the page
  EXPECT_FALSE(fitting_pitch(request, room));
}

TEST(SetLayout, ARotatedGratingIsWider) {
  Marker marker;
  marker.grating =
      Grating{.centre = {0.0, 0.0}, .width_mm = 30.0, .height_mm = 30.0, .pitch_mm = 5.0, .angle_rad = std::atan(1.0)};
  EXPECT_NEAR(extent_of(marker).width(), 30.0 * std::sqrt(2.0), 1e-9);
}

}  // namespace
}  // namespace moiregauge::internal::sheet
