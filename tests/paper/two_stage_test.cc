// SPDX-License-Identifier: Apache-2.0
// Tests the paper's cases with an ideal lens: the accuracy of the published method when its model is right.
#include <cmath>
#include <tuple>

#include <gtest/gtest.h>

#include "common/simulated_run.h"

namespace moiregauge::internal {
namespace {

struct Case {
  const char* scenario;
  long reference_frame;
};
// The reference frame of the 8 deg case is the one in which the camera faces the board, as in the paper.
constexpr Case kRig[] = {{"rig-0.1x", 0}, {"rig-1x", 0}, {"rig-1xyz", 0}, {"rig-8xyz", 80}};

TEST(TwoStageIdealLens, NoiseFreeTheErrorStaysBelowTheSamplingLimit) {
  constexpr double kGate_um = 1.5;
  for (const Case& c : kRig) {
    const auto scenario = *simulator::built_in(c.scenario);
    test::RunPlan plan;
    plan.grain = test::Grain::kNoiseFree;
    plan.step = 7;
    plan.reference_frame = c.reference_frame;
    const auto run = test::measured(scenario, plan);
    ASSERT_TRUE(run.problem.empty()) << c.scenario << ": " << run.problem;
    EXPECT_EQ(run.error_y_um.size(), run.samples.size()) << c.scenario;
    EXPECT_LE(test::largest(run.error_y_um), kGate_um) << c.scenario;
    RecordProperty(c.scenario, std::to_string(test::largest(run.error_y_um)));
  }
}

// Returns the rms about each run's mean, relative to the single-frame bound of the method's own averaged regions.
double ratio_to_bound(const char* name, long reference_frame, int seeds, long step, double& largest_um) {
  std::vector<double> scatters, bounds;
  largest_um = 0.0;
  for (int seed = 1; seed <= seeds; ++seed) {
    auto scenario = *simulator::built_in(name);
    scenario.seed = static_cast<std::uint64_t>(seed);
    test::RunPlan plan;
    plan.reference_frame = reference_frame;
    plan.step = step;
    const auto run = test::measured(scenario, plan);
    EXPECT_TRUE(run.problem.empty()) << name << ": " << run.problem;
    scatters.push_back(test::scatter(run.error_y_um));
    for (const Sample& s : run.samples) bounds.push_back(1000.0 * std::hypot(s.budget.noise.y, s.budget.references.y));
    largest_um = std::max(largest_um, test::largest(run.error_y_um));
  }
  return test::rms(scatters) / test::rms(bounds);
}

TEST(TwoStageIdealLens, WithTheRigsNoiseTheScatterIsThatOfItsOwnRegions) {
  constexpr int kSeeds = 5;
  for (const auto& [name, reference, gate] :
       {std::tuple{"rig-0.1x", 0L, 1.3}, {"rig-1x", 0L, 1.3}, {"rig-1xyz", 0L, 1.3}, {"rig-8xyz", 80L, 1.8}}) {
    double largest_um = 0.0;
    const double ratio = ratio_to_bound(name, reference, kSeeds, 8, largest_um);  // 20 frames x 5 seeds
    EXPECT_LE(ratio, gate) << name;
    EXPECT_LE(largest_um, 6.0) << name;
    RecordProperty(name, std::to_string(ratio) + " x bound, max " + std::to_string(largest_um) + " um");
  }
}

TEST(TwoStageIdealLens, AStrongTargetMotionIsFollowedThroughManyPitches) {
  auto scenario = *simulator::built_in("small-1x");
  for (auto& marker : scenario.markers) {
    if (marker.print.role != Role::kTarget) continue;
    marker.dy = simulator::Track({{-1.0, 0.0}, {8.0, 26.0}});  // 0.29 mm per frame, 2.6 pitches
  }
  test::RunPlan plan;
  plan.frames = 81;
  const auto run = test::measured(scenario, plan);
  ASSERT_TRUE(run.problem.empty()) << run.problem;
  ASSERT_EQ(run.error_y_um.size(), run.samples.size());
  // um. A wrong fringe order would be 10 000. It is 6 at rest, and the far edge is noisier.
  EXPECT_LE(test::largest(run.error_y_um), 12.0);
}

}  // namespace
}  // namespace moiregauge::internal
