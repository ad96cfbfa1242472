// SPDX-License-Identifier: Apache-2.0
// Tests measuring with the pitch alone, which must be as good as with the site file.
#include <gtest/gtest.h>

#include "common/simulated_run.h"
#include "moiregauge/observation/reference/site_from_picture.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

using simulator::Scenario;

PictureSiteOptions upright() { return {10.0, BoardAxes::kImage}; }

tl::expected<PictureSite, ReferenceFailure> looked(const Scenario& scenario, long frame,
                                                   const PictureSiteOptions& options) {
  const auto picture = simulator::render8(scenario, frame, {0, simulator::Area::kMarkersOnly});
  return detect_site({picture.view(), 8}, Camera{}, options);
}

tl::expected<Site, ReferenceFailure> found(const Scenario& scenario, long frame) {
  const auto picture = simulator::render8(scenario, frame, {0, simulator::Area::kMarkersOnly});
  return site_from_picture({picture.view(), 8}, Camera{}, {10.0, BoardAxes::kPrint, {}});
}

Scenario with_pattern(const char* name, Pattern pattern, double angle_deg = 0.0) {
  Scenario scenario = *simulator::built_in(name);
  for (auto& marker : scenario.markers) {
    marker.print.grating->pattern = pattern;
    marker.print.grating->angle_rad = radians_from_degrees(angle_deg);
  }
  return scenario;
}

simulator::SceneMarker extra(BoardPoint at, double size_mm, double pitch_mm) {
  simulator::SceneMarker marker;
  marker.print.name = "extra";
  marker.print.role = Role::kTarget;
  marker.print.grating =
      Grating{.centre = at, .width_mm = size_mm, .height_mm = size_mm, .pitch_mm = pitch_mm, .pattern = Pattern::kGrid};
  marker.paper_margin_mm = 3.0;
  return marker;
}

std::size_t count(const Site& site, Role role) {
  std::size_t n = 0;
  for (const Marker& m : site.markers) n += m.role == role ? 1U : 0U;
  return n;
}

TEST(WithoutSite, TheMarkersAreWhereTheRigHasThem) {
  for (const char* name : {"small-1xyz", "rig-1xyz", "rig-8xyz"}) {
    const auto scenario = *simulator::built_in(name);
    const Site truth = simulator::site_of(scenario);
    for (const long frame : {0L, 80L, 160L}) {
      const auto site = found(scenario, frame);
      ASSERT_TRUE(site) << name << " " << frame << ": " << site.error().message;
      ASSERT_EQ(site->markers.size(), truth.markers.size()) << name << " " << frame;
      for (std::size_t i = 0; i < truth.markers.size(); ++i) {  // NW NE SW SE mid, which is also the reading order
        const Marker &a = site->markers[i], &b = truth.markers[i];
        EXPECT_EQ(a.name, i < 4 ? "R" + std::to_string(i + 1) : "T1");
        ASSERT_TRUE(a.grating);
        EXPECT_EQ(a.grating->pattern, Pattern::kAuto);
        // The target has moved by up to 2 mm. An outline may be a strip off on one side.
        EXPECT_LE(length(a.grating->centre - b.grating->centre), 2.5) << name << " " << frame << " " << a.name;
        EXPECT_LE(a.grating->width_mm, b.grating->width_mm) << name << " " << frame << " " << a.name;
        EXPECT_LE(a.grating->height_mm, b.grating->height_mm) << name << " " << frame << " " << a.name;
        EXPECT_GE(a.grating->width_mm, 0.94 * b.grating->width_mm) << name << " " << frame << " " << a.name;
      }
    }
  }
}

// The same frames, read in windows from a search and in those of the site file: the same noise in almost the same
// pixels.
TEST(WithoutSite, EveryPatternReadsAsWellAsWithTheSiteFile) {
  for (const Pattern pattern :
       {Pattern::kGrid, Pattern::kSquares, Pattern::kDots, Pattern::kCheckerboard, Pattern::kCosine}) {
    for (const double angle_deg : {0.0, 20.0}) {
      if (angle_deg > 0.0 && pattern != Pattern::kGrid) continue;
      const Scenario scenario = with_pattern("small-1xyz", pattern, angle_deg);
      test::RunPlan plan;
      plan.step = 8;
      const auto given = test::measured(scenario, plan);
      auto site = looked(scenario, 0, upright());
      ASSERT_TRUE(site) << word_for(pattern) << " " << angle_deg << ": " << site.error().message;
      ASSERT_EQ(site->site.markers.size(), 5U) << word_for(pattern);
      site->site.markers.back().name = "mid";  // its name in the truth
      plan.site = site->site;
      const auto own = test::measured(scenario, plan);
      ASSERT_EQ(own.problem, "") << word_for(pattern);
      ASSERT_EQ(own.error_y_um.size(), 20U) << word_for(pattern);
      EXPECT_LT(test::scatter(own.error_y_um), 1.2 * test::scatter(given.error_y_um))
          << word_for(pattern) << " " << angle_deg;
      EXPECT_LT(test::scatter(own.error_x_um), 1.2 * test::scatter(given.error_x_um))
          << word_for(pattern) << " " << angle_deg;
    }
  }
}

TEST(WithoutSite, FineCoarseAndSlantedPrintsAreFound) {
  for (const double pitch_px : {7.0, 12.0, 29.0}) {
    for (const double tilt_deg : {-40.0, 0.0, 40.0}) {
      Scenario scenario = *simulator::built_in("small-1x");
      const double scale = 29.0 / pitch_px;  // the same image with finer lattices
      scenario.mount.distance_mm *= scale;
      scenario.mount.board_y_deg = tilt_deg;
      for (auto& marker : scenario.markers) {
        Grating& g = *marker.print.grating;
        g.centre = {scale * g.centre.x, scale * g.centre.y};
        g.width_mm *= scale;
        g.height_mm *= scale;
        if (marker.print.circle)
          marker.print.circle = Circle{{scale * marker.print.circle->centre.x, scale * marker.print.circle->centre.y},
                                       scale * marker.print.circle->diameter_mm};
      }
      const auto site = found(scenario, 0);
      ASSERT_TRUE(site) << pitch_px << " " << tilt_deg << ": " << site.error().message;
      ASSERT_EQ(site->markers.size(), 5U) << pitch_px << " " << tilt_deg;
      // A local pitch is known to about 1e-4. Perspective from four of them is known to that over their share of the
      // image.
      EXPECT_NEAR(length(site->markers[3].circle->centre - site->markers[0].circle->centre),
                  scale * std::hypot(256.0, 80.0), 0.005 * scale * 256.0)
          << pitch_px << " " << tilt_deg;
    }
  }
}

TEST(WithoutSite, ThreeCirclesAreTooFewAndAreCounted) {
  auto scenario = *simulator::built_in("small-1x");
  scenario.markers.erase(scenario.markers.begin());
  const auto site = found(scenario, 0);
  ASSERT_FALSE(site);
  EXPECT_NE(site.error().message.find("were not found (3 circles"), std::string::npos) << site.error().message;
}

TEST(WithoutSite, WithoutATargetThereIsNothingToMeasure) {
  auto scenario = *simulator::built_in("small-1x");
  scenario.markers.pop_back();
  const auto site = found(scenario, 0);
  ASSERT_FALSE(site);
  EXPECT_NE(site.error().message.find("there is no target"), std::string::npos) << site.error().message;
}

TEST(WithoutSite, CirclesWithoutGratingsAreNoReferences) {
  auto scenario = *simulator::built_in("small-1x");
  for (auto& marker : scenario.markers) {
    if (marker.print.role == Role::kReference) marker.print.grating.reset();
  }
  const auto site = found(scenario, 0);
  ASSERT_FALSE(site);
  EXPECT_NE(
      site.error().message.find("no grating is within three diameters of a reference circle (4 circles and 1 grating"),
      std::string::npos)
      << site.error().message;
}

TEST(WithoutSite, AFixedCameraNeedsNoCircles) {
  auto scenario = *simulator::built_in("small-1x");
  scenario.markers.erase(scenario.markers.begin(), scenario.markers.begin() + 4);
  auto options = upright();
  options.needs_references = false;
  const auto site = looked(scenario, 0, options);
  ASSERT_TRUE(site) << site.error().message;
  EXPECT_EQ(count(site->site, Role::kReference), 0U);
  EXPECT_EQ(count(site->site, Role::kTarget), 1U);
}

TEST(WithoutSite, ASecondGratingAtACircleIsATargetAndIsNamed) {
  auto scenario = *simulator::built_in("small-1x");
  scenario.markers.push_back(extra({-62.0, 48.0}, 28.0, 10.0));  // 2.4 diameters from the upper left circle's edge
  auto site = looked(scenario, 0, upright());
  ASSERT_TRUE(site) << site.error().message;
  EXPECT_EQ(count(site->site, Role::kReference), 4U);
  ASSERT_EQ(count(site->site, Role::kTarget), 2U);
  // The nearer grating belongs to the circle.
  EXPECT_NEAR(site->site.markers[0].grating->centre.x, -100.0, 1.0);
  EXPECT_NEAR(site->site.markers[4].grating->centre.x, -62.0, 1.0);
  scenario.markers.back().print.grating->centre.x = -75.0 + 1.5;
  scenario.markers.back().print.grating->width_mm = 24.0;
  site = looked(scenario, 0, upright());
  ASSERT_TRUE(site) << site.error().message;
  ASSERT_EQ(site->notes.size(), 1U);
  EXPECT_NE(site->notes[0].find("is used as a target"), std::string::npos) << site->notes[0];
}

TEST(WithoutSite, AGratingOfAnotherPitchIsExcludedAndNamed) {
  auto scenario = *simulator::built_in("small-1x");
  scenario.markers.push_back(extra({45.0, 0.0}, 30.0, 7.0));
  const auto site = looked(scenario, 0, upright());
  ASSERT_TRUE(site) << site.error().message;
  EXPECT_EQ(count(site->site, Role::kTarget), 1U);
  ASSERT_EQ(site->notes.size(), 1U);
  EXPECT_NE(site->notes[0].find("its pitch is 7 mm"), std::string::npos) << site->notes[0];
}

}  // namespace
}  // namespace moiregauge::internal
