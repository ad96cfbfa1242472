// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/identity/layout_symmetry.h"

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

Site rectangle_of_circles() {
  Site site;
  for (const BoardPoint at : {BoardPoint{-380, 28}, {380, 28}, {-380, -28}, {380, -28}}) {
    Marker marker;
    marker.circle = Circle{at, 20.0};
    site.markers.push_back(marker);
  }
  return site;
}

TEST(LayoutSymmetry, ARectangleOfEqualCirclesHidesEveryFlip) {
  const auto note = symmetry_note(rectangle_of_circles());
  ASSERT_TRUE(note);
  EXPECT_EQ(note->rfind("note: a mirrored, upside-down or half-rotated image cannot be recognised", 0), 0U) << *note;
}

TEST(LayoutSymmetry, OneCircleOfAnotherSizeRevealsEveryFlip) {
  Site site = rectangle_of_circles();
  site.markers[0].circle->diameter_mm = 25.0;
  EXPECT_FALSE(symmetry_note(site));
  site.markers[0].circle->diameter_mm = 21.0;  // 5 %: within the tolerance of the identification
  EXPECT_TRUE(symmetry_note(site));
}

TEST(LayoutSymmetry, OneCircleOutOfLineRevealsEveryFlip) {
  Site site = rectangle_of_circles();
  site.markers[3].circle->centre.x -= 120.0;
  EXPECT_FALSE(symmetry_note(site));
}

TEST(LayoutSymmetry, ATrapeziumHidesItsMirrorImageAlone) {
  Site site = rectangle_of_circles();
  site.markers[0].circle->centre.x += 120.0;
  site.markers[1].circle->centre.x -= 120.0;
  const auto note = symmetry_note(site);
  ASSERT_TRUE(note);
  EXPECT_EQ(note->rfind("note: a mirrored image", 0), 0U) << *note;
}

}  // namespace
}  // namespace moiregauge::internal
