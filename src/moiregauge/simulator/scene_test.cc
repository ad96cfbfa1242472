// SPDX-License-Identifier: Apache-2.0
// Site errors, covers, rolling shutters and orbits of the simulator.
#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "moiregauge/simulator/scenario/settings.h"
#include "moiregauge/simulator/simulator.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::simulator {
namespace {

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

TEST(SiteErrors, AreDrawnWithTheStatedUncertainties) {
  Scenario scenario = *built_in("small-1xyz");
  scenario.known_to = {
      .position_mm = 5.0, .rotation_rad = radians_from_degrees(0.2), .height_mm = 2.0, .print_scale = 1e-3};
  scenario.draw = {.position = true, .rotation = true, .height = true, .print_scale = true};
  std::vector<double> position, rotation, height, scale;
  for (scenario.seed = 1; scenario.seed <= 500; ++scenario.seed) {
    for (const SceneMarker& marker : scenario.markers) {
      const auto place = true_place(scenario, marker);
      position.push_back(place.x_mm / 5.0);
      position.push_back(place.y_mm / 5.0);
      rotation.push_back(place.rotation_deg / 0.2);
      scale.push_back(place.print_scale / 1e-3);
      if (marker.print.role == Role::kReference) height.push_back(place.z_mm / 2.0);
      if (marker.print.role == Role::kTarget) {
        EXPECT_EQ(place.z_mm, 0.0) << "it states no height";
      }
    }
  }
  for (const auto& drawn : {position, rotation, height, scale})
    EXPECT_NEAR(rms(drawn), 1.0, 4.0 / std::sqrt(2.0 * static_cast<double>(drawn.size())));
}

TEST(SiteErrors, DoNotChangeTheStatedSiteOrTheTruth) {
  const Scenario stated = *built_in("small-1xyz");
  Scenario scenario = stated;
  scenario.known_to.position_mm = 5.0;
  scenario.draw.position = true;
  EXPECT_EQ(site_of(scenario).known_to.position_mm, 5.0);
  EXPECT_EQ(site_of(scenario).markers[0].grating->centre.x, -100.0);
  EXPECT_EQ(truth(scenario, 30, *find_marker(scenario, "mid")).dy_mm,
            truth(stated, 30, *find_marker(stated, "mid")).dy_mm);
  const SceneMarker& marker = *find_marker(scenario, "NE");
  const auto there = project(scenario, 0, marker, {0.0, 0.0}), stated_there = project(stated, 0, marker, {0.0, 0.0});
  EXPECT_NEAR(there.x - stated_there.x, true_place(scenario, marker).x_mm * 3478.26 / 1200.0, 1e-9);
}

TEST(SiteErrors, OfOneMarkerDoNotDependOnTheOthers) {
  Scenario scenario = *built_in("small-1xyz");
  scenario.draw.position = true;
  const double before = true_place(scenario, *find_marker(scenario, "mid")).x_mm;
  scenario.markers.erase(scenario.markers.begin());
  EXPECT_EQ(true_place(scenario, *find_marker(scenario, "mid")).x_mm, before);
  scenario.draw.seed = 99;
  EXPECT_NE(true_place(scenario, *find_marker(scenario, "mid")).x_mm, before);
}

TEST(PrintScale, StretchesThePitchByTheStatedAmount) {
  Scenario scenario = *built_in("small-still");
  SceneMarker& marker = scenario.markers[1];
  const BoardPoint centre = marker.print.grating->centre;
  const auto pitch_px = [&] {
    return project(scenario, 0, marker, {centre.x + 10.0, centre.y}).x - project(scenario, 0, marker, centre).x;
  };
  const double nominal = pitch_px();
  const ImagePoint middle = project(scenario, 0, marker, centre);
  marker.place.print_scale = 0.003;
  EXPECT_NEAR(pitch_px() / nominal, 1.003, 1e-12);
  EXPECT_NEAR(length(project(scenario, 0, marker, centre) - middle), 0.0, 1e-12) << "its middle stays";
}

// The edge of a circle that is 1 % too large must be drawn at the position given by `project`.
TEST(PrintScale, IsDrawn) {
  Scenario scenario = *built_in("small-still");
  SceneMarker& marker = scenario.markers[1];
  marker.place.print_scale = 0.01;
  const BoardPoint c = marker.print.circle->centre;
  const double edge = project(scenario, 0, marker, {c.x + 8.0, c.y}).x;
  const auto picture = render_ideal(scenario, 0);
  const int y = static_cast<int>(std::lround(project(scenario, 0, marker, c).y));
  const int from = static_cast<int>(project(scenario, 0, marker, c).x);
  double dark = 0.5;  // px; half of pixel `from` is beyond its centre
  for (int x = from + 1; x < from + 40; ++x) dark += (210.0 - picture.at(x, y)) / 170.0;
  // The row may miss the centre by 0.5 px, which changes the edge by (0.5 px)^2 / (2 x 23 px).
  EXPECT_NEAR(from + dark, edge, 0.02);
}

TEST(Cover, HidesItsMarkerInItsFramesOnly) {
  Scenario scenario = *built_in("small-covered");
  scenario.markers[1].cover.grey = 77.0;
  const auto before = render_ideal(scenario, 39), during = render_ideal(scenario, 40),
             after = render_ideal(scenario, 60);
  Scenario open = scenario;
  open.markers[1].cover.frames.clear();
  const auto uncovered = render_ideal(open, 40), open_after = render_ideal(open, 60);
  const SceneMarker& marker = scenario.markers[1];
  const BoardPoint c = marker.print.grating->centre;
  for (const double dx : {-14.0, -5.0, 0.0, 7.0, 28.0, 35.0}) {  // grating, paper, circle
    const ImagePoint p = project(scenario, 40, marker, {c.x + dx, c.y + 3.0});
    EXPECT_NEAR(during.at(int(p.x), int(p.y)), 77.0, 1e-9);
  }
  const ImagePoint elsewhere = project(scenario, 40, scenario.markers[0], scenario.markers[0].print.grating->centre);
  for (int x = 0; x < int(elsewhere.x) + 60; ++x)
    EXPECT_EQ(during.at(x, int(elsewhere.y)), uncovered.at(x, int(elsewhere.y)));
  EXPECT_GT(before.at(int(elsewhere.x), int(elsewhere.y)), 0.0);
  EXPECT_TRUE(std::equal(after.row(100).begin(), after.row(100).end(), open_after.row(100).begin()));
}

TEST(Cover, HidesItsShareOfTheSheet) {
  Scenario scenario = *built_in("small-still");
  SceneMarker& target = scenario.markers.back();
  target.cover = {.frames = {{0, 1}}, .share = 0.25, .grey = 77.0};
  const auto picture = render_ideal(scenario, 0);
  // The sheet is 60 mm wide around (0, 0), so it is covered from -30 to -15 mm.
  const ImagePoint edge = project(scenario, 0, target, {-15.0, 0.0});
  for (int x = int(edge.x) - 40; x < int(edge.x) - 4; ++x) EXPECT_NEAR(picture.at(x, int(edge.y)), 77.0, 1e-9);
  double differs = 0.0;
  for (int x = int(edge.x) + 5; x < int(edge.x) + 40; ++x)
    differs = std::max(differs, std::abs(picture.at(x, int(edge.y)) - 77.0));
  EXPECT_GT(differs, 30.0) << "the print is visible outside";
}

// A camera rotating about y at w rad/s moves the middle of the image at f w px/s. A row exposed later by t is shifted
// by f w t.
TEST(RollingShutter, WithARotatingCameraShearsTheImage) {
  Scenario scenario = *built_in("small-still");
  scenario.mount.pivot_z_mm = 0.0;
  scenario.sensor.exposure_s = 0.0;
  scenario.mount.rotation_y.knots = {{-1.0, -1.0}, {1.0, 1.0}};  // 1 deg/s
  const auto global = render_ideal(scenario, 0);
  scenario.sensor.readout_s = 0.08;
  const auto rolling = render_ideal(scenario, 0);
  const double rate_px = scenario.camera.fx * radians_from_degrees(1.0);
  // Measures the left edge of the target's grating in a row, by the sum of the white paper up to it.
  const auto edge_of = [](const Image<double>& picture, int y) {
    double white = 0.0;
    for (int x = 432; x < 462; ++x) white += (picture.at(x, y) - 40.0) / 170.0;
    return white;
  };
  // These rows are on dark lines of the grating, so its edge is a step from paper to black.
  for (const int y : {226, 284}) {
    const double shear = edge_of(rolling, y) - edge_of(global, y);
    const double expected = rate_px * 0.08 * ((y + 0.5) / 512.0 - 0.5);
    EXPECT_NEAR(shear, expected, 0.03 * std::abs(expected)) << "row " << y;
  }
  EXPECT_EQ(truth(scenario, 0, scenario.markers.back()).dx_mm, 0.0) << "the truth is the frame's, whatever the row";
}

TEST(RollingShutter, WithoutReadoutTimeEqualsTheGlobalShutter) {
  Scenario scenario = *built_in("small-1xyz");
  const auto global = render_ideal(scenario, 7);
  scenario.sensor.readout_s = 1e-12;
  const auto rolling = render_ideal(scenario, 7);
  for (int y = 0; y < 512; y += 5) {
    for (int x = 0; x < 1024; ++x) ASSERT_NEAR(rolling.at(x, y), global.at(x, y), 1e-6);
  }
}

TEST(RandomTrack, HoldsOneValuePerStepAndFillsItsRange) {
  const Track track{.random = 2.0, .random_seed = 5};
  std::vector<double> values;
  for (int n = 0; n < 2000; ++n) {
    values.push_back(track.at(0.1 * n));
    EXPECT_EQ(track.at(0.1 * n + 0.04), values.back());
    EXPECT_NEAR(track.mean(0.1 * n - 0.02, 0.1 * n + 0.03), values.back(), 1e-12);
    EXPECT_LE(std::abs(values.back()), 2.0);
  }
  // Uniform numbers have an rms of 2 / sqrt(3). The relative standard error of the rms of n of them is 1 / sqrt(5 n).
  EXPECT_NEAR(rms(values) * std::sqrt(3.0) / 2.0, 1.0, 4.0 / std::sqrt(5.0 * 2000));
  EXPECT_NEAR(track.mean(0.05, 0.25), 0.5 * (values[1] + values[2]), 1e-12);
  EXPECT_NE(Mount{}.rotation_x.random_seed, Mount{}.rotation_y.random_seed);
}

TEST(Orbit, DoesNotMoveTheImageOfTheBoardsMiddle) {
  const Scenario scenario = *built_in("small-orbit-40");
  for (const long frame : {0L, 40L, 80L, 160L}) {
    const ImagePoint p = project(scenario, frame, {0.0, 0.0});
    EXPECT_NEAR(p.x, scenario.camera.cx, 1e-9);
    EXPECT_NEAR(p.y, scenario.camera.cy, 1e-9);
  }
  // At 40 degrees about y, lengths along x are foreshortened by cos 40.
  const double seen = project(scenario, 160, {1.0, 0.0}).x - project(scenario, 160, {-1.0, 0.0}).x;
  EXPECT_NEAR(seen / (2.0 * 3478.26 / 1200.0), std::cos(radians_from_degrees(40.0)), 1e-5);
}

TEST(BuiltIn, EveryMarkerStaysInTheImage) {
  for (const BuiltIn& entry : built_in_scenarios()) {
    Scenario scenario = *built_in(std::string(entry.name));
    EXPECT_EQ(problem_with(scenario), std::nullopt) << entry.name;
    double margin = 1e9;
    for (long frame = 0; frame < scenario.frames; ++frame) {
      for (const SceneMarker& marker : scenario.markers) {
        const Grating& g = *marker.print.grating;
        std::vector<BoardPoint> corners;
        for (int i = 0; i < 4; ++i)
          corners.push_back({g.centre.x + ((i & 1) - 0.5) * g.width_mm, g.centre.y + ((i >> 1) - 0.5) * g.height_mm});
        if (marker.print.circle) {
          const Circle& c = *marker.print.circle;
          for (int i = 0; i < 4; ++i)
            corners.push_back(
                {c.centre.x + ((i & 1) - 0.5) * c.diameter_mm, c.centre.y + ((i >> 1) - 0.5) * c.diameter_mm});
        }
        for (const BoardPoint corner : corners) {
          const ImagePoint p = project(scenario, frame, marker, corner);
          margin = std::min({margin, p.x, p.y, scenario.camera.width - 1 - p.x, scenario.camera.height - 1 - p.y});
        }
      }
    }
    EXPECT_GT(margin, 8.0) << entry.name;
  }
}

TEST(BuiltIn, TheWalkHasTheStatedSpeed) {
  const Scenario scenario = *built_in("small-walk");
  const SceneMarker& target = scenario.markers.back();
  double fastest = 0.0, lowest = 1e9, highest = -1e9;
  for (long frame = 0; frame < scenario.frames; ++frame) {
    const double here = truth(scenario, frame, target).dy_mm;
    if (frame > 0) fastest = std::max(fastest, std::abs(here - truth(scenario, frame - 1, target).dy_mm));
    lowest = std::min(lowest, here);
    highest = std::max(highest, here);
  }
  EXPECT_NEAR(fastest / 10.0, 0.63, 0.006);
  EXPECT_NEAR(lowest, 0.0, 0.5);
  EXPECT_NEAR(highest, 60.0, 0.5);
}

}  // namespace
}  // namespace moiregauge::internal::simulator
