// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/model/rolling_shutter.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include <gtest/gtest.h>

#include "moiregauge/calibration/scene/footage_for_tests.h"

namespace moiregauge::internal {
namespace {

using test::Angles, test::Footage, test::footage_of, test::kFootageSeed, test::lens, test::Recording;

// The camera turns by up to 10 deg/s. Frames are 43 ms apart.
Angles turning(double s) { return {2.0 * s, std::sin(5.0 * s), std::sin(10.0 * s)}; }

Shutter solved_from(const Recording& truth, const Footage& run, std::optional<double> given) {
  const ScenePrior prior = scene_prior(truth.site, truth.camera.width, truth.camera.height, std::nullopt);
  std::vector<std::size_t> key(run.frames.size());
  std::iota(key.begin(), key.end(), std::size_t{0});
  return solve_shutter(truth.site, test::series_of(run.frames), key, prior, given);
}

Shutter solved_for(double readout_s, std::optional<double> given) {
  const Recording truth{.camera = lens(-0.0225), .angles = turning, .readout_s = readout_s};
  return solved_from(truth, footage_of(truth, 24), given);
}

// Fast sensors read all rows in a few milliseconds, at any frame rate.
TEST(SolveShutter, KeepsAGivenReadoutMuchShorterThanTheFrameInterval) {
  constexpr double kReadout = 0.006;  // s
  const Shutter solved = solved_for(kReadout, kReadout);
  ASSERT_EQ(solved.problem, "");
  EXPECT_FALSE(solved.bounded);
  EXPECT_NEAR(solved.readout_s / kReadout, 1.0, 2.0 * kGivenReadout) << "seed " << kFootageSeed;
}

class UnknownReadout : public testing::TestWithParam<double> {};

// Lens and readout time are correlated on a flat rig: solved in turn, each keeps the other's error. The error stays
// within 3 u, and so does that of the focal length.
TEST_P(UnknownReadout, IsFoundFarFromThePriorTogetherWithTheLens) {
  const Shutter solved = solved_for(GetParam(), std::nullopt);
  ASSERT_EQ(solved.problem, "");
  EXPECT_FALSE(solved.bounded);
  EXPECT_NEAR(solved.readout_s, GetParam(), 3.0 * solved.u_readout_s) << "seed " << kFootageSeed;
  EXPECT_LT(solved.u_readout_s, 0.01 * GetParam()) << "a hundredth, although the prior allows a half";
  const Scene& scene = solved.calibration.bundle.scene;
  EXPECT_NEAR(scene.camera.fx, lens(0.0).fx, 3.0 * std::sqrt(scene.covariance(0, 0))) << "seed " << kFootageSeed;
}

INSTANTIATE_TEST_SUITE_P(SolveShutter, UnknownReadout, testing::Values(0.003, 0.006, 0.012, 0.020, 0.030));

// One of four references creeps by 1 mm in 24 frames that are exposed at once, while the camera turns. The search ends
// without a readout time: in every round the frames contradict the scene.
TEST(SolveShutter, FindsNoReadoutTimeWhereAReferenceCreeps) {
  const Recording truth{.camera = lens(-0.0225), .angles = [](double s) { return Angles{s, s, s}; }};
  const std::size_t creeps = static_cast<std::size_t>(std::distance(
      truth.site.markers.begin(), std::ranges::find(truth.site.markers, Role::kReference, &Marker::role)));
  const Footage run = footage_of(truth, 24, [=](std::size_t marker, int frame) -> Extent<frame::Board> {
    return {0.0, marker == creeps ? frame / 23.0 : 0.0};
  });
  const Shutter solved = solved_from(truth, run, std::nullopt);
  EXPECT_EQ(solved.problem, "no readout time explains the frames")
      << "readout " << solved.readout_s << " s, u " << solved.u_readout_s << ", chi2/dof "
      << solved.calibration.shutter.chi2_dof << ", seed " << kFootageSeed;
}

}  // namespace
}  // namespace moiregauge::internal
