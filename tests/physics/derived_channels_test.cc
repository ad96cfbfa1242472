// SPDX-License-Identifier: Apache-2.0
// Tests the joint covariance of simulated runs: its diagonal is the stated u, and derived channels scatter by their u.
#include <cmath>
#include <cstdio>

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

// Frames of a run share the errors of the scene, so six runs have at least six degrees of freedom. The relative standard
// error of their scatter is at most 1 / sqrt(12), 29 %. That of a share of 95.4 % is at most 8.6 %. Three are allowed.
TEST(DerivedChannels, AZeroOverThirtyFramesHoldsItsUncertainty) {
  constexpr int kRuns = 6;
  const auto runs =
      study::in_parallel("zeros", kRuns, [](int n) { return study::zeroed_run(static_cast<std::uint64_t>(n) + 31); });
  std::vector<double> pulls, u_zero, u_alone;
  for (const auto& run : runs) {
    ASSERT_TRUE(run.problem.empty()) << run.problem;
    const auto &alone = run.channels.at("reference frame"), &zero = run.channels.at("zero");
    u_alone.insert(u_alone.end(), alone.u.begin(), alone.u.end());
    u_zero.insert(u_zero.end(), zero.u.begin(), zero.u.end());
    for (std::size_t k = 0; k < zero.u.size(); ++k) pulls.push_back(zero.error[k] / zero.u[k]);
  }
  ASSERT_EQ(pulls.size(), static_cast<std::size_t>(kRuns * study::kFramesAfterZero));
  const double theory = std::sqrt((1.0 + 1.0 / 30.0) / 2.0), ratio = test::rms(u_zero) / test::rms(u_alone);
  double inside = 0.0;
  for (const double pull : pulls) inside += std::abs(pull) < 2.0 ? 1.0 / static_cast<double>(pulls.size()) : 0.0;
  std::printf("zero over 30 frames: u %.3f of that of the first frame (theory %.3f), rms pull %.2f, inside U %.2f\n",
              ratio, theory, test::rms(pulls), inside);
  EXPECT_NEAR(ratio, theory, 0.1 * theory);
  EXPECT_NEAR(test::rms(pulls), 1.0, 3.0 / std::sqrt(2.0 * kRuns));
  EXPECT_GE(inside, 0.954 - 3.0 * std::sqrt(0.954 * 0.046 / kRuns));
}

// The bound of a frame is that of its pixels (rotation_run). The difference of two frames has both bounds, squared and
// added. The estimate may be worse for three reasons. Pose, blur and contrast of the frame are fitted to the same pixels.
// The noise of the references enters. The template is learned from the reference frame.
TEST(DerivedChannels, TheOwnRotationOfAPrintIsNearItsCramerRaoBound) {
  constexpr int kRuns = 4;
  constexpr long kFrames = 21;  // the reference frame and 20 others
  const auto runs = study::in_parallel(
      "rotations", kRuns, [](int n) { return study::rotation_run(static_cast<std::uint64_t>(n) + 61, kFrames); });
  std::vector<double> off, error, u, of_frame, of_difference;
  for (const auto& run : runs) {
    ASSERT_TRUE(run.problem.empty()) << run.problem;
    ASSERT_EQ(run.error.size(), 20U);
    double mean = 0.0;
    for (const double e : run.error) mean += e / static_cast<double>(run.error.size());
    // About its mean over n frames, an error has (n - 1) / n of its variance.
    const double lost = std::sqrt(20.0 / 19.0);
    for (std::size_t k = 0; k < run.error.size(); ++k) {
      off.push_back(lost * (run.error[k] - mean));
      error.push_back(run.error[k]);
      u.push_back(run.u[k]);
      of_frame.push_back(run.bound[k]);
      of_difference.push_back(std::hypot(run.bound[k], run.bound_of_reference));
    }
  }
  std::printf("own rotation: scatter of a frame %.2f, u %.2f, error %.2f of the Cramer-Rao bound of %.1f urad\n",
              test::rms(off) / test::rms(of_frame), test::rms(u) / test::rms(of_difference),
              test::rms(error) / test::rms(of_difference), 1e6 * test::rms(of_difference));
  EXPECT_LE(test::rms(off), 1.5 * test::rms(of_frame));
  EXPECT_LE(test::rms(error), 1.5 * test::rms(of_difference));
  // u also holds the shares of lens, geometry and references, and the noise of short runs is overstated by 4 %.
  EXPECT_LE(test::rms(u), 1.6 * test::rms(of_difference));
  EXPECT_GE(test::rms(u), test::rms(of_difference)) << "no estimate without bias is better than the bound";
}

}  // namespace
}  // namespace moiregauge::internal
