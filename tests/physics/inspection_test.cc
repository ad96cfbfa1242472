// SPDX-License-Identifier: Apache-2.0
// Tests the results of `inspect` on a simulated frame against the simulator.
#include <cmath>

#include <gtest/gtest.h>

#include "common/simulated_run.h"
#include "moiregauge/displacement/expected_uncertainty.h"
#include "moiregauge/observation/views/inspection.h"
#include "moiregauge/simulator/simulator.h"

namespace moiregauge::internal {
namespace {

// Small rig in the middle of its rotation, 1/2 degree about three axes.
constexpr long kFrame = 80;
const simulator::Scenario& scenario() {
  static const auto made = simulator::built_in("small-1xyz").value();
  return made;
}
const Image<std::uint8_t>& picture() {
  static const auto made = render8(scenario(), kFrame, {0, simulator::Area::kMarkersOnly});
  return made;
}
const Inspection& with_pitch() {
  static const Inspection made = inspect_picture({picture().view(), 8}, {.pitch_mm = 10.0});
  return made;
}

TEST(Inspection, EveryMarkerHasItsCircleAndItsGrating) {
  const Inspection& seen = with_pitch();
  ASSERT_TRUE(seen.reference) << seen.missing;
  ASSERT_EQ(seen.reference->site.markers.size(), 5U);
  ASSERT_EQ(seen.circles.size(), 4U);
  ASSERT_EQ(seen.patches.size(), 5U);
  std::vector<int> circles(5), patches(5);
  for (const InspectedCircle& c : seen.circles) ++circles.at(static_cast<std::size_t>(c.marker));
  for (const InspectedPatch& p : seen.patches) ++patches.at(static_cast<std::size_t>(p.marker));
  EXPECT_EQ(circles, (std::vector<int>{1, 1, 1, 1, 0}));
  EXPECT_EQ(patches, (std::vector<int>{1, 1, 1, 1, 1}));
}

TEST(Inspection, PitchAndDirectionAreThoseOfThePrint) {
  for (const InspectedPatch& p : with_pitch().patches) {
    const Grating& print = *with_pitch().reference->site.markers[static_cast<std::size_t>(p.marker)].grating;
    // One pitch from the grating's centre to the right and upwards, as the simulator projects it.
    const auto at = [&](double x, double y) {
      return project(scenario(), kFrame, BoardPoint{print.centre.x + x, print.centre.y + y});
    };
    const ImageExtent x = 0.5 * (at(10.0, 0.0) - at(-10.0, 0.0)), y = 0.5 * (at(0.0, 10.0) - at(0.0, -10.0));
    const PatchAxes axes = axes_of(p.seen);
    // A fit over three pitches of 29 px with a noise of 3 % of the amplitude: 1e-3 of a pitch, 3e-4 of its length.
    EXPECT_LT(length(axes.x - x), 1e-3 * length(x));
    EXPECT_LT(length(axes.y - y), 1e-3 * length(y));
  }
}

TEST(Inspection, WithoutAPitchTheSameMarkersAreFound) {
  const Inspection seen = inspect_picture({picture().view(), 8}, {});
  ASSERT_TRUE(seen.reference) << seen.missing;
  EXPECT_EQ(seen.unit, BoardUnit::kPitch);
  ASSERT_EQ(seen.patches.size(), with_pitch().patches.size());
  for (std::size_t i = 0; i < seen.patches.size(); ++i)
    EXPECT_EQ(seen.patches[i].marker, with_pitch().patches[i].marker);
}

TEST(Inspection, DetectionsAreKeptWhenIdentificationFails) {
  auto cut = scenario();
  cut.markers.erase(cut.markers.begin());
  const auto three = render8(cut, 0, {0, simulator::Area::kMarkersOnly});
  const Inspection seen = inspect_picture({three.view(), 8}, {.pitch_mm = 10.0});
  EXPECT_FALSE(seen.reference);
  EXPECT_EQ(seen.circles.size(), 3U);
  EXPECT_EQ(seen.patches.size(), 4U);
  EXPECT_NE(seen.missing.find("(3 circles"), std::string::npos) << seen.missing;
}

// The scatter of one frame's displacement about its run's mean is u without the reference frame's half.
TEST(Inspection, TheExpectedUncertaintyEqualsTheScatter) {
  const auto still = simulator::built_in("small-0.1x").value();
  const auto first = render8(still, 0, {0, simulator::Area::kMarkersOnly});
  const Inspection seen = inspect_picture({first.view(), 8}, {.site = simulator::site_of(still)});
  ASSERT_TRUE(seen.reference) << seen.missing;
  const auto expected = expected_uncertainties(*seen.reference, {});
  ASSERT_EQ(expected.size(), 1U);
  test::RunPlan plan;
  plan.first = 1;
  plan.frames = 72;
  const test::MeasuredRun run = test::measured(still, plan);
  ASSERT_EQ(run.error_y_um.size(), 72U) << run.problem;
  // A scatter of n = 72 has u = 1 / sqrt(2 n) = 8 %. Three of them are allowed, and 5 % for frames that differ from the
  // first in light and position.
  for (const auto& [u_mm, errors] : {std::pair{expected[0].u.x, run.error_x_um}, {expected[0].u.y, run.error_y_um}})
    EXPECT_NEAR(test::scatter(errors) / (1000.0 * u_mm / std::sqrt(2.0)), 1.0, 0.3);
  EXPECT_LT(expected[0].bound.x, expected[0].u.x);
  EXPECT_LT(expected[0].bound.y, expected[0].u.y);
}

}  // namespace
}  // namespace moiregauge::internal
