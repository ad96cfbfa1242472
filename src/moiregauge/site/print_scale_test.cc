// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/site/print_scale.h"

#include <cmath>

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

Site one_sheet() {
  Marker marker;
  marker.name = "NW";
  marker.circle = Circle{{-380.0, 28.0}, 20.0};
  marker.grating = Grating{.centre = {-340.0, 28.0}, .width_mm = 40.0, .height_mm = 30.0, .pitch_mm = 10.0};
  return {{marker}, {}};
}

TEST(PrintScale, PrintsGrowAboutTheGratingAndItsPositionStays) {
  const Marker printed = with_prints_scaled(one_sheet(), {1.01}).markers.front();
  EXPECT_DOUBLE_EQ(printed.grating->pitch_mm, 10.1);
  EXPECT_DOUBLE_EQ(printed.grating->width_mm, 40.4);
  EXPECT_DOUBLE_EQ(printed.grating->height_mm, 30.3);
  EXPECT_EQ(printed.grating->centre.x, -340.0);
  EXPECT_DOUBLE_EQ(printed.circle->diameter_mm, 20.2);
  EXPECT_DOUBLE_EQ(printed.circle->centre.x, -380.4);
  EXPECT_EQ(printed.circle->centre.y, 28.0);
}

TEST(PrintScale, RulersWithoutAnUncertaintyKeepTheSitesValue) {
  EXPECT_EQ(with_prints_scaled(one_sheet(), {1.01}).known_to.print_scale, KnownTo{}.print_scale);
  EXPECT_EQ(with_prints_scaled(one_sheet(), {1.01, 1e-4}).known_to.print_scale, 1e-4);
}

// The axes are 0.1 % off their mean each. This is the least uncertainty, whatever u is stated for the rulers.
TEST(PrintScale, RulersThatDifferEnlargeTheUncertainty) {
  PrintScale scale = mean_of_rulers(1.001, 1.003);
  EXPECT_DOUBLE_EQ(scale.factor, 1.002);
  EXPECT_NEAR(with_prints_scaled(one_sheet(), scale).known_to.print_scale, 0.001, 1e-12);
  scale.u = 1e-4;
  EXPECT_NEAR(with_prints_scaled(one_sheet(), scale).known_to.print_scale, std::hypot(0.001, 1e-4), 1e-12);
}

// Circle and grating are on one sheet. Its position is counted in pitches, distances on it are not.
TEST(PrintScale, PositionsCountedInPitchesGrowWithThePitch) {
  const Marker moved = with_places_scaled(one_sheet(), 1.01).markers.front();
  EXPECT_DOUBLE_EQ(moved.grating->centre.x, -343.4);
  EXPECT_DOUBLE_EQ(moved.circle->centre.x, -383.4);
  EXPECT_EQ(moved.grating->pitch_mm, 10.0);
}

TEST(PrintScale, ScalingBackGivesTheNominalSite) {
  const Marker back = with_prints_scaled(with_prints_scaled(one_sheet(), {1.0012}), {1.0 / 1.0012}).markers.front();
  EXPECT_NEAR(back.grating->pitch_mm, 10.0, 1e-12);
  EXPECT_NEAR(back.circle->centre.x, -380.0, 1e-12);
}

}  // namespace
}  // namespace moiregauge::internal
