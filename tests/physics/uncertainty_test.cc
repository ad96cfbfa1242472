// SPDX-License-Identifier: Apache-2.0
// Tests that the stated noise equals the scatter of repeated recordings, and that layouts follow their closed forms.
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "common/simulated_run.h"
#include "moiregauge/planning/reference_weights.h"

namespace moiregauge::internal {
namespace {

TEST(Layout, FlatLayoutsAreWorseSideways) {
  // u_x = (s/2) sqrt(1 + (a/b)^2), u_y = (s/2) sqrt(1 + (b/a)^2) for references at (+-a, +-b), target in the centre.
  for (const auto& [a, b] : {std::pair{380.0, 28.0}, {100.0, 100.0}, {60.0, 300.0}}) {
    const std::array<BoardPoint, 4> references{{{-a, b}, {a, b}, {-a, -b}, {a, -b}}};
    const auto weights = reference_weights(references, {0.0, 0.0});
    const std::vector<Extent<frame::Board>> u(4, {1.0, 1.0});
    const auto at_target = through_references(weights, u);
    EXPECT_NEAR(at_target.x, 0.5 * std::hypot(1.0, a / b), 1e-9 * a / b);
    EXPECT_NEAR(at_target.y, 0.5 * std::hypot(1.0, b / a), 1e-9 * b / a + 1e-9);
  }
}

TEST(Layout, ACommonShiftOfTheReferencesShiftsTheTargetByTheSame) {
  const std::array<BoardPoint, 5> references{{{-380, 28}, {380, 28}, {-380, -28}, {380, -28}, {10, 200}}};
  Matrix2 sum = Matrix2::Zero();
  for (const Matrix2& w : reference_weights(references, {12.0, -7.0})) sum += w;
  EXPECT_NEAR((sum - Matrix2::Identity()).norm(), 0.0, 1e-9);
}

TEST(Uncertainty, TheStatedNoiseIsTheScatterOfRepeatedRecordings) {
  // A fixed camera, 10 runs of 30 frames: scatter about each run's mean against the noise and references parts of u.
  std::vector<double> scatter_y, stated_y;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    auto scenario = *simulator::built_in("small-0.1x");
    scenario.seed = seed;
    scenario.mount.rotation_x = {};
    test::RunPlan plan;
    plan.frames = 31;
    const auto run = test::measured(scenario, plan);
    ASSERT_TRUE(run.problem.empty()) << run.problem;
    scatter_y.push_back(test::scatter(run.error_y_um));
    for (const Sample& s : run.samples)
      stated_y.push_back(1000.0 * std::hypot(s.budget.noise.y, s.budget.references.y));
  }
  // 290 degrees of freedom: the relative standard error is 1 / sqrt(580) = 4.2 %. Four of them are allowed.
  EXPECT_NEAR(test::rms(scatter_y) / test::rms(stated_y), 1.0, 0.17);
}

}  // namespace
}  // namespace moiregauge::internal
