// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/identity/matching_sheets.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "moiregauge/detection/identity/select_references.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr double kPitch = 20.0;  // px

// Returns a square grating of `periods` pitches per side in a front view.
DetectedPatch grating(ImagePoint centre, double periods = 3.0) {
  DetectedPatch p;
  p.centre = centre;
  const double half = 0.5 * periods * kPitch;
  p.outline = {ImagePoint{centre.x - half, centre.y - half},
               {centre.x + half, centre.y - half},
               {centre.x + half, centre.y + half},
               {centre.x - half, centre.y + half}};
  p.k_x = {1.0 / kPitch, 0.0};
  p.k_y = {0.0, -1.0 / kPitch};
  p.periods_x = p.periods_y = periods;
  return p;
}

DetectedCircle circle(ImagePoint centre, double axis_ratio = 1.0) {
  DetectedCircle c;
  c.centre = centre;
  c.diameter_px = 32.0;
  c.axis_ratio = axis_ratio;
  c.contrast = -120.0;
  return c;
}

struct SheetScene {
  std::vector<DetectedCircle> circles;
  std::vector<DetectedPatch> patches;
};

// Returns four sheets, each with a circle 56 px from the centre of its grating, and a target in the middle.
SheetScene rig() {
  SheetScene s;
  for (const ImagePoint c : {ImagePoint{250, 170}, {750, 170}, {250, 340}, {750, 340}}) {
    s.circles.push_back(circle(c));
    s.patches.push_back(grating({c.x + (c.x < 500 ? 56.0 : -56.0), c.y}));
  }
  s.patches.push_back(grating({500, 255}, 4.0));
  return s;
}

bool has(const std::vector<DetectedCircle>& circles, ImagePoint centre) {
  return std::any_of(circles.begin(), circles.end(),
                     [&](const DetectedCircle& c) { return length(c.centre - centre) < 1.0; });
}

TEST(LikeSheets, FourCirclesNextToGratingsOfOneKindAreASet) {
  const SheetScene s = rig();
  EXPECT_EQ(matching_sheets(s.circles, s.patches).size(), 4U);
}

TEST(LikeSheets, FalseCandidatesWithoutAGratingAreNotAmongTheOutermost) {
  SheetScene s = rig();
  for (const ImagePoint c : {ImagePoint{30, 30}, {990, 30}, {990, 480}, {30, 480}}) s.circles.push_back(circle(c));
  const auto select_references = outermost_circles(s.circles, s.patches);
  EXPECT_FALSE(select_references.doubtful);
  ASSERT_EQ(select_references.circles.size(), 4U);
  EXPECT_TRUE(has(select_references.circles, {250, 170}));
  EXPECT_TRUE(has(select_references.circles, {750, 340}));
}

TEST(LikeSheets, AFalseCandidateNextToTheTargetHasAnotherRelativePosition) {
  SheetScene s = rig();
  s.circles.push_back(circle({500, 80}));  // 175 px from the centre of the target; a reference has 56 px
  const auto sheets = matching_sheets(s.circles, s.patches);
  ASSERT_EQ(sheets.size(), 4U);
  for (const LikeSheet& sheet : sheets) EXPECT_NE(sheet.patch, 4U);
}

TEST(LikeSheets, AnEllipseIsNoCircleOfThatPlane) {
  SheetScene s = rig();
  s.circles[0] = circle(s.circles[0].centre, 0.7);
  EXPECT_EQ(matching_sheets(s.circles, s.patches).size(), 3U);
  EXPECT_NEAR(out_of_round(s.circles[0], s.patches[0]), -std::log(0.7), 1e-12);
}

// On a board tilted by 40 degrees about y, circles and lattices are narrower by the same factor.
TEST(LikeSheets, ACircleViewedAtAnAngleIsRoundOnItsOwnPlane) {
  const double narrow = std::cos(radians_from_degrees(40.0));
  SheetScene s = rig();
  for (DetectedCircle& c : s.circles) {
    c.centre.x *= narrow;
    c.axis_ratio = narrow;
    c.angle_rad = 0.5 * kPi;
    c.diameter_px *= std::sqrt(narrow);
  }
  for (DetectedPatch& p : s.patches) {
    p.centre.x *= narrow;
    for (ImagePoint& corner : p.outline) corner.x *= narrow;
    p.k_x.x /= narrow;
  }
  EXPECT_NEAR(out_of_round(s.circles[0], s.patches[0]), 0.0, 1e-12);
  EXPECT_EQ(matching_sheets(s.circles, s.patches).size(), 4U);
}

TEST(LikeSheets, TwoFalseCandidatesForAMissingReferenceAreDoubtful) {
  SheetScene s = rig();
  s.circles.erase(s.circles.begin());
  s.circles.push_back(circle({60, 60}));
  EXPECT_FALSE(outermost_circles(s.circles, s.patches).doubtful);  // four of one size: a reference may lack its grating
  s.circles.push_back(circle({60, 440}));
  EXPECT_TRUE(outermost_circles(s.circles, s.patches).doubtful);
}

TEST(LikeSheets, BareCirclesAroundThreeSheetsAreReferencesAndTheSheetsTargets) {
  SheetScene s;
  for (const ImagePoint c : {ImagePoint{30, 30}, {990, 30}, {990, 480}, {30, 480}, {510, 20}})
    s.circles.push_back(circle(c));
  for (const double x : {250.0, 500.0, 750.0}) {
    s.circles.push_back(circle({x, 255}));
    s.patches.push_back(grating({x + 56.0, 255}));
  }
  const auto select_references = outermost_circles(s.circles, s.patches);
  EXPECT_FALSE(select_references.doubtful);
  EXPECT_EQ(select_references.circles.size(), 5U);
}

}  // namespace
}  // namespace moiregauge::internal
