// SPDX-License-Identifier: Apache-2.0
// Tests the detection of grids of thin ink-jet lines without a site file, against the simulator.
#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "moiregauge/detection/gratings/grating_patches.h"
#include "moiregauge/simulator/scenario/built_in.h"
#include "moiregauge/simulator/simulator.h"

namespace moiregauge::internal {
namespace {

// Returns one pitch on the grating about its centre, as the simulator projects it, px.
ImageExtent projected_pitch(const simulator::Scenario& scenario, const simulator::SceneMarker& marker, double x,
                            double y) {
  const Grating& print = *marker.print.grating;
  const double half_mm = 0.5 * print.pitch_mm;
  const auto at = [&](double side) {
    return project(scenario, 0, marker,
                   BoardPoint{print.centre.x + side * half_mm * x, print.centre.y + side * half_mm * y});
  };
  return at(1.0) - at(-1.0);
}

// Returns the cycles of a wave along a pitch: 1 along its own axis, 0 along the other.
double cycles(ImageExtent wave, ImageExtent pitch) { return wave.x * pitch.x + wave.y * pitch.y; }

// The outline may lack the last line and the smoothing on either side, half a pitch each. It may extend into the paper
// by the width of the smoothing, a sixth of a pitch each.
void expect_extent_of_print(double periods, double size_mm, double pitch_mm) {
  EXPECT_GT(periods, size_mm / pitch_mm - 1.0);
  EXPECT_LT(periods, size_mm / pitch_mm + 1.0 / 3.0);
}

TEST(ThinLines, EveryInkJetGridIsOneGrating) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U}) {
    auto scenario = simulator::built_in("small-ink").value();
    scenario.seed = seed;
    const auto picture = render8(scenario, 0, {0, simulator::Area::kWholeFrame});
    const auto patches = find_grating_patches(picture.view(), {});
    EXPECT_EQ(patches.size(), 5U) << "seed " << seed;
    for (const simulator::SceneMarker& marker : scenario.markers) {
      SCOPED_TRACE(marker.print.name + ", seed " + std::to_string(seed));
      const Grating& print = *marker.print.grating;
      const ImagePoint centre = project(scenario, 0, marker, BoardPoint{print.centre.x, print.centre.y});
      const auto patch =
          std::find_if(patches.begin(), patches.end(), [&](const DetectedPatch& p) { return holds(p, centre); });
      ASSERT_NE(patch, patches.end());
      EXPECT_EQ(patch->pattern, Pattern::kAuto);  // crossed, neither a checkerboard nor a cosine
      EXPECT_TRUE(patch->dark_on_light);
      expect_extent_of_print(patch->periods_x, print.width_mm, print.pitch_mm);
      expect_extent_of_print(patch->periods_y, print.height_mm, print.pitch_mm);
      // The outline's centre is up to half a pitch from the grating's, where perspective differs by 1e-3.
      const ImageExtent x = projected_pitch(scenario, marker, 1.0, 0.0),
                        y = projected_pitch(scenario, marker, 0.0, 1.0);
      EXPECT_NEAR(cycles(patch->k_x, x), 1.0, 3e-3);
      EXPECT_NEAR(cycles(patch->k_y, y), 1.0, 3e-3);
      EXPECT_NEAR(cycles(patch->k_x, y), 0.0, 3e-3);
      EXPECT_NEAR(cycles(patch->k_y, x), 0.0, 3e-3);
    }
  }
}

}  // namespace
}  // namespace moiregauge::internal
