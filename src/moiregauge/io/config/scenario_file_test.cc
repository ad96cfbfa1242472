// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/config/scenario_file.h"

#include <gtest/gtest.h>

#include "moiregauge/simulator/scenario/built_in.h"
#include "moiregauge/simulator/scenario/scenario.h"

namespace moiregauge::internal {
namespace {

constexpr const char* kBeam = R"(
base = "small-1x"
frames = 50
[lens]
k1 = -0.1
[grating]
pitch_mm = 8.0
pattern = "squares"
[rotation.z]
knots = [[0, 0], [5, 0.8]]
[[marker]]
name = "beam"
role = "target"
grating_mm = [1, 2]
grating_size_mm = [40, 40]
pattern = "dots"
[marker.dy]
knots = [[0, 0], [2, 1]]
)";

TEST(ScenarioFile, StatesTheDifferencesFromItsBase) {
  const auto scenario = parse_scenario(kBeam, "beam.toml");
  ASSERT_TRUE(scenario) << scenario.error().front();
  EXPECT_EQ(scenario->frames, 50);
  EXPECT_EQ(scenario->camera.k1, -0.1);
  EXPECT_EQ(scenario->camera.fx, 3478.26);
  EXPECT_EQ(scenario->mount.rotation_z.at(2.5), 0.4);
  ASSERT_EQ(scenario->markers.size(), 1U);
  const simulator::SceneMarker& beam = scenario->markers[0];
  EXPECT_EQ(beam.print.role, Role::kTarget);
  EXPECT_EQ(beam.print.grating->pitch_mm, 8.0);
  EXPECT_EQ(beam.print.grating->pattern, Pattern::kDots) << "a marker's own word is the last";
  EXPECT_EQ(beam.dy.at(1.0), 0.5);
}

TEST(ScenarioFile, ListsAllMistakesWithTheirPositions) {
  const auto scenario = parse_scenario("frames = 2.5\n[lens]\nk9 = 1\n", "bad.toml");
  ASSERT_FALSE(scenario);
  ASSERT_EQ(scenario.error().size(), 2U);
  EXPECT_EQ(scenario.error()[0].substr(0, 11), "bad.toml:1:");
  EXPECT_NE(scenario.error()[1].find("the key \"lens.k9\" is unknown, did you mean \"lens.k"), std::string::npos);
}

TEST(Setting, ChangesOneValue) {
  auto scenario = *simulator::built_in("rig-1x");
  EXPECT_TRUE(apply_setting(scenario, "lens.k1=-0.0225"));
  EXPECT_EQ(scenario.camera.k1, -0.0225);
  EXPECT_TRUE(apply_setting(scenario, "marker.mid.dy.scale=0"));
  EXPECT_EQ(scenario.markers.back().dy.at(3.0), 0.0);
  EXPECT_TRUE(apply_setting(scenario, "grating.pattern=cosine"));
  EXPECT_EQ(scenario.markers.front().print.grating->pattern, Pattern::kCosine);
}

TEST(Setting, StatesTheUncertaintyOfTheSiteAndTheDraws) {
  const auto scenario = parse_scenario(
      "base = \"small-1x\"\n[truth]\ndraw_print_scale = false\ndraw_known_to = true\n[known_to]\nposition_mm = 5\n"
      "rotation_deg = 0.5\n",
      "drawn.toml");
  ASSERT_TRUE(scenario) << scenario.error().front();
  EXPECT_EQ(scenario->known_to.position_mm, 5.0);
  EXPECT_EQ(scenario->known_to.height_mm, 3.0) << "the default where the file is silent";
  EXPECT_TRUE(scenario->draw.position && scenario->draw.rotation && scenario->draw.height);
  EXPECT_FALSE(scenario->draw.print_scale) << "the word about one kind is the last, wherever it stands";
}

TEST(Setting, SetsOcclusionsReadoutAndRandomPoses) {
  auto scenario = *simulator::built_in("small-1x");
  EXPECT_TRUE(apply_setting(scenario, "marker.NE.cover.frames=[[20, 40], [60, 61]]"));
  EXPECT_EQ(scenario.markers[1].cover.frames[1].from, 60);
  EXPECT_FALSE(apply_setting(scenario, "marker.NE.cover.frames=[20, 40.5]"));
  EXPECT_FALSE(apply_setting(scenario, "marker.NE.cover.frames=[40, 20]"));
  EXPECT_TRUE(apply_setting(scenario, "sensor.readout_s=0.02"));
  EXPECT_EQ(simulator::delay_of_row(scenario, 511), 0.02 * (0.5 - 0.5 / 512));
  EXPECT_TRUE(apply_setting(scenario, "shift.x.random=50"));
  EXPECT_NE(scenario.mount.shift_x.at(0.1), scenario.mount.shift_x.at(0.2));
  EXPECT_TRUE(apply_setting(scenario, "marker.NE.place.print_scale=0.001"));
  EXPECT_EQ(simulator::true_place(scenario, scenario.markers[1]).print_scale, 0.001);
}

TEST(Setting, WithAnImpossibleValueIsRefused) {
  auto scenario = *simulator::built_in("rig-1x");
  EXPECT_FALSE(apply_setting(scenario, "lens.k1=much"));
  EXPECT_FALSE(apply_setting(scenario, "lens.k1=nan"));
  EXPECT_FALSE(apply_setting(scenario, "lens.k1"));
  EXPECT_FALSE(apply_setting(scenario, "grating.pattern=auto"));
  EXPECT_FALSE(apply_setting(scenario, "seed=-1"));
}

TEST(ScenarioFile, AllImpossibleValuesAreReportedWithTheirPositions) {
  const auto read = parse_scenario(
      "base = \"small-1x\"\nframs = 3\n[lens]\nk1 = nan\n[sensor]\nfps = -1\n[grating]\npitch_mm = -10.0\n"
      "[known_to]\nprint_scale = 3.0\n",
      "s.toml");
  ASSERT_FALSE(read);
  const std::vector<std::string> expected{
      "s.toml:2:9: the key \"frams\" is unknown, did you mean \"frames\"?", "s.toml:4:6: lens.k1 must be a number",
      "s.toml:6:7: sensor.fps must be greater than 0", "s.toml:8:12: marker NW, pitch_mm must be greater than 0",
      "s.toml:10:15: known_to.print_scale must be 0.1 at most"};
  EXPECT_EQ(read.error(), expected);
}

TEST(ScenarioFile, AMissingValueHasNoPosition) {
  EXPECT_EQ(parse_scenario("frames = 3\n", "s.toml").error(),
            std::vector<std::string>{"s.toml:1:1: the scenario has no marker"});
}

}  // namespace
}  // namespace moiregauge::internal
