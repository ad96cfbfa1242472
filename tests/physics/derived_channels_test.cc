// SPDX-License-Identifier: Apache-2.0
// Tests the joint covariance of simulated runs: its diagonal is the stated u, and derived channels scatter by their u.
#include <cmath>

#include <gtest/gtest.h>

#include "studies/derive_cases.h"
#include "studies/in_parallel.h"

namespace moiregauge::internal {
namespace {

TEST(DerivedChannels, TheDiagonalOfTheJointCovarianceIsTheStatedUncertainty) {
  test::RunPlan plan{.method = "precise", .frames = 6, .all_targets = true};
  const auto run = test::measured(study::derived_scenario(7), plan);
  ASSERT_TRUE(run.problem.empty()) << run.problem;
  const auto [solution, joint] = study::solve_jointly(run);
  ASSERT_EQ(joint.targets.size(), 3U);
  ASSERT_EQ(joint.frames.size(), 6U);
  for (std::size_t n = 0; n < joint.frames.size(); ++n) {
    for (std::size_t t = 0; t < 3; ++t) {
      const Sample& sample = solution.samples[3 * n + t];
      for (const Quantity axis : {Quantity::kDx, Quantity::kDy}) {
        const Eigen::Index row = quantity_row(t, axis);
        const FrameErrors& errors = joint.frames[n];
        const double u = std::sqrt(errors.noise(row, row) + errors.varying.row(row).squaredNorm() +
                                   errors.constant_share * joint.constant.row(row).squaredNorm());
        const double stated = axis == Quantity::kDx ? sample.u.x : sample.u.y;
        EXPECT_NEAR(u, stated, 1e-9 * stated) << n << " " << t;  // rounding of a sum of squares
      }
    }
  }
}

TEST(DerivedChannels, TheirErrorsScatterByTheirUncertainty) {
  constexpr int kRuns = 12;
  const auto runs = study::in_parallel("derived channels", kRuns,
                                       [](int n) { return study::derived_run(static_cast<std::uint64_t>(n) + 101); });
  std::map<std::string, std::vector<double>> pulls;  // errors in their u
  for (const auto& run : runs) {
    ASSERT_TRUE(run.problem.empty()) << run.problem;
    for (const auto& [name, channel] : run.channels) {
      ASSERT_EQ(channel.error.size(), 13U) << name;
      for (std::size_t k = 0; k < channel.error.size(); ++k) pulls[name].push_back(channel.error[k] / channel.u[k]);
    }
  }
  // The frames of a run share most of their errors, so 12 runs have at least 12 degrees of freedom. The relative
  // standard error is at most 1 / sqrt(24) = 20 %. Three of them are allowed.
  for (const auto& [name, pull] : pulls) EXPECT_NEAR(test::rms(pull), 1.0, 0.61) << name;
}

// A zero over 30 frames has the noise of its mean: sqrt(1 + 1/30) of a frame's instead of sqrt(2). What the scene adds
// grows with the movement, so the run is short and u may exceed this by 10 %.
TEST(DerivedChannels, AZeroOverThirtyFramesLowersUAsTheorySays) {
  const auto run = study::zeroed_run(3);
  ASSERT_TRUE(run.problem.empty()) << run.problem;
  const auto& alone = run.channels.at("reference frame");
  const auto& zero = run.channels.at("zero");
  ASSERT_EQ(zero.u.size(), 4U);
  EXPECT_NEAR(test::rms(zero.u) / test::rms(alone.u), std::sqrt((1.0 + 1.0 / 30.0) / 2.0), 0.072);
  for (std::size_t k = 0; k < zero.u.size(); ++k) EXPECT_LT(std::abs(zero.error[k]), 4.0 * zero.u[k]);
}

}  // namespace
}  // namespace moiregauge::internal
