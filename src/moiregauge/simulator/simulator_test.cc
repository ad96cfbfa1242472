// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/simulator/simulator.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "moiregauge/units/units.h"

namespace moiregauge::internal::simulator {
namespace {

Track turned_by(double degrees) {
  Track track;
  track.offset = degrees;
  return track;
}

TEST(Rig, HasTheFocalLengthAndScaleOfThePaper) {
  const Scenario rig = *built_in("rig-1x");
  const ImagePoint a = project(rig, 0, {0.0, 0.0}), b = project(rig, 0, {10.0, 0.0}), c = project(rig, 0, {0.0, 10.0});
  EXPECT_NEAR(10.0 / (b.x - a.x), 0.345, 1e-4);
  EXPECT_LT(c.y, a.y) << "the board's y points up";
}

TEST(Rig, StaysInTheImageAtAllSignsOfFourDegrees) {
  Scenario rig = *built_in("rig-8xyz");
  double margin = 1e9;
  for (int signs = 0; signs < 8; ++signs) {
    rig.mount.rotation_x = turned_by((signs & 1) != 0 ? 4.0 : -4.0);
    rig.mount.rotation_y = turned_by((signs & 2) != 0 ? 4.0 : -4.0);
    rig.mount.rotation_z = turned_by((signs & 4) != 0 ? 4.0 : -4.0);
    for (const SceneMarker& marker : rig.markers) {
      const Grating& g = *marker.print.grating;
      for (int corner = 0; corner < 4; ++corner) {
        const double x = (corner & 1) != 0 ? 0.5 : -0.5, y = (corner & 2) != 0 ? 0.5 : -0.5;
        const ImagePoint p = project(rig, 0, marker, {g.centre.x + x * g.width_mm, g.centre.y + y * g.height_mm});
        margin = std::min({margin, p.x, p.y, rig.camera.width - 1 - p.x, rig.camera.height - 1 - p.y});
      }
      if (!marker.print.circle) continue;
      for (int i = 0; i < 90; ++i) {
        const double angle = kTwoPi * i / 90, r = 0.5 * marker.print.circle->diameter_mm;
        const BoardPoint c = marker.print.circle->centre;
        const ImagePoint p = project(rig, 0, marker, {c.x + r * std::cos(angle), c.y + r * std::sin(angle)});
        margin = std::min({margin, p.x, p.y, rig.camera.width - 1 - p.x, rig.camera.height - 1 - p.y});
      }
    }
  }
  EXPECT_GT(margin, 10.0);
  EXPECT_LT(margin, 13.0);
}

TEST(Rig, ARotationAboutTheOpticalCentreMovesTheImageByItsTangent) {
  Scenario rig = *built_in("rig-1x");
  rig.mount.pivot_z_mm = 0.0;
  rig.mount.rotation_x = turned_by(2.0);
  const ImagePoint p = project(rig, 0, {0.0, 0.0});
  EXPECT_NEAR(p.y, rig.camera.cy - rig.camera.fy * std::tan(radians_from_degrees(2.0)), 1e-9);
}

TEST(Truth, IsRelativeToFrameZeroAndTheMeanOverTheExposure) {
  const Scenario rig = *built_in("rig-1x");
  const SceneMarker& target = *find_marker(rig, "mid");
  EXPECT_EQ(truth(rig, 0, target).dy_mm, 0.0);
  // The second half of frame 0's exposure T is on the ramp of 0.5 mm/s: a mean of 0.5 * (T/2) / 2 / 2.
  const double start = 0.5 * rig.sensor.exposure_s / 8.0;
  EXPECT_NEAR(truth(rig, 10, target).dy_mm, 0.5 - start, 1e-12);
  EXPECT_NEAR(truth(rig, 70, target).dy_mm, 2.0 - start, 1e-12);
  EXPECT_NEAR(truth(rig, 160, target).dy_mm, -start, 1e-12);
  EXPECT_EQ(truth(rig, 160, *find_marker(rig, "NW")).dx_mm, 0.0);
}

TEST(Rendering, ThreadsNeverChangeAByte) {
  const Scenario scenario = *built_in("small-1xyz");
  const auto one = render8(scenario, 7, {.threads = 1}), two = render8(scenario, 7, {.threads = 2});
  for (int y = 0; y < one.height(); ++y) {
    ASSERT_TRUE(std::equal(one.row(y).begin(), one.row(y).end(), two.row(y).begin())) << "row " << y;
  }
}

TEST(Rendering, MarkersOnlyDrawsTheSameMarkers) {
  const Scenario scenario = *built_in("small-1xyz");
  const auto whole = render8(scenario, 3), part = render8(scenario, 3, {.area = Area::kMarkersOnly});
  for (const SceneMarker& marker : scenario.markers) {
    const ImagePoint p = project(scenario, 3, marker, marker.print.grating->centre);
    for (int d = -70; d <= 70; ++d) {
      const int x = static_cast<int>(p.x) + d, y = static_cast<int>(p.y);
      EXPECT_EQ(whole.at(x, y), part.at(x, y));
    }
  }
  EXPECT_EQ(part.at(0, 0), 110);
}

TEST(Noise, HasTheStatedScatterAndNoMean) {
  Scenario scenario = *built_in("small-1x");
  scenario.sensor.bits = 12;  // makes the quantisation noise negligible
  const auto picture = std::get<Image<std::uint16_t>>(render(scenario, 0));
  double sum = 0.0, squares = 0.0;
  constexpr int kRows = 60, kColumns = 1024;  // above and below the markers
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < kColumns; ++x) {
      for (const int row : {y, 511 - y}) {
        const double d = picture.at(x, row) / 16.0 - scenario.light.background;
        sum += d;
        squares += d * d;
      }
    }
  }
  const double n = kRows * kColumns;
  EXPECT_NEAR(sum / n, 0.0, 4.0 * 1.5 / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(squares / n) / 1.5, 1.0, 4.0 / std::sqrt(2.0 * n));
}

TEST(Noise, OfZeroLeavesOnlyRounding) {
  Scenario scenario = *built_in("small-1x");
  scenario.sensor.noise_sigma = 0.0;
  const auto stored = render8(scenario, 5);
  const auto light = render_ideal(scenario, 5);
  for (int y = 0; y < stored.height(); y += 3) {
    for (int x = 0; x < stored.width(); ++x) EXPECT_LE(std::abs(stored.at(x, y) - light.at(x, y)), 0.5);
  }
}

TEST(Site, ListsReferencesFirstAndNoFalseCandidates) {
  Scenario scenario = *built_in("rig-1x");
  std::rotate(scenario.markers.begin(), scenario.markers.end() - 1, scenario.markers.end());
  scenario.markers[1].listed = false;
  const Site site = site_of(scenario);
  ASSERT_EQ(site.markers.size(), 4U);
  EXPECT_EQ(site.markers.back().name, "mid");
}

}  // namespace
}  // namespace moiregauge::internal::simulator
