// SPDX-License-Identifier: Apache-2.0
// Measuring with nothing but the pitch: as good as with the site file.
#include <gtest/gtest.h>

#include "common/simulated_run.h"
#include "moiregauge/observation/site_from_picture.h"

namespace moiregauge {
namespace {

tl::expected<Site, ReferenceFailure> found(const simulator::Scenario& scenario, long frame) {
  const auto picture = simulator::render8(scenario, frame, {0, simulator::Area::kMarkersOnly});
  return site_from_picture({picture.view(), 8}, Camera{}, {10.0, BoardAxes::kPrint, {}});
}

TEST(WithoutSite, TheMarkersAreWhereTheRigHasThem) {
  for (const char* name : {"small-1xyz", "rig-1xyz", "rig-8xyz"}) {
    const auto scenario = *simulator::built_in(name);
    const Site truth = simulator::site_of(scenario);
    for (const long frame : {0L, 80L, 160L}) {
      const auto site = found(scenario, frame);
      ASSERT_TRUE(site) << name << " " << frame << ": " << site.error().message;
      ASSERT_EQ(site->markers.size(), truth.markers.size()) << name << " " << frame;
      for (std::size_t i = 0; i < truth.markers.size(); ++i) {  // NW NE SW SE mid: reading order as well
        const Marker &a = site->markers[i], &b = truth.markers[i];
        EXPECT_EQ(a.name, i < 4 ? "R" + std::to_string(i + 1) : "T1");
        ASSERT_TRUE(a.grating);
        EXPECT_EQ(a.grating->pattern, Pattern::kAuto);
        EXPECT_LE(length(a.grating->centre - b.grating->centre), 4.0) << name << " " << frame << " " << a.name;
        EXPECT_LE(a.grating->width_mm, b.grating->width_mm) << name << " " << frame << " " << a.name;
        EXPECT_LE(a.grating->height_mm, b.grating->height_mm) << name << " " << frame << " " << a.name;
        EXPECT_GE(a.grating->width_mm, 0.9 * b.grating->width_mm) << name << " " << frame << " " << a.name;
      }
    }
  }
}

TEST(WithoutSite, ThreeCirclesAreTooFewAndAreCounted) {
  auto scenario = *simulator::built_in("small-1x");
  scenario.markers.erase(scenario.markers.begin());
  const auto site = found(scenario, 0);
  ASSERT_FALSE(site);
  EXPECT_NE(site.error().message.find("found 3"), std::string::npos) << site.error().message;
}

TEST(WithoutSite, WithoutATargetThereIsNothingToMeasure) {
  auto scenario = *simulator::built_in("small-1x");
  scenario.markers.pop_back();
  const auto site = found(scenario, 0);
  ASSERT_FALSE(site);
  EXPECT_NE(site.error().message.find("no target"), std::string::npos) << site.error().message;
}

}  // namespace
}  // namespace moiregauge
