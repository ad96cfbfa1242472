// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/model/rolling_shutter.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "moiregauge/calibration/scene/footage_for_tests.h"

namespace moiregauge::internal {
namespace {

using test::Angles, test::Footage, test::footage_of, test::kFootageSeed, test::lens, test::Recording;

// The camera turns by up to 10 deg/s. Frames are 43 ms apart.
Angles turning(double s) { return {2.0 * s, std::sin(5.0 * s), std::sin(10.0 * s)}; }

Shutter solved_from(const Recording& truth, const FrameSeries& frames, std::optional<double> given,
                    std::shared_ptr<const MovementRemoval> movements = nullptr, double chi2_dof_at_once = 0.0) {
  const ScenePrior prior = scene_prior(truth.site, truth.camera.width, truth.camera.height, std::nullopt);
  std::vector<std::size_t> key(frames.size());
  std::iota(key.begin(), key.end(), std::size_t{0});
  return solve_shutter({truth.site, frames, key, prior, given, std::move(movements), chi2_dof_at_once});
}

Shutter solved_from(const Recording& truth, const Footage& run, std::optional<double> given) {
  return solved_from(truth, test::series_of(run.frames), given);
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

// One of four references creeps by 1 mm in 24 frames that are exposed at once, while the camera turns. A path along the
// rows explains some of it, but no readout time is above its noise.
TEST(SolveShutter, ACreepingReferenceIsNoRollingShutter) {
  const Recording truth{.camera = lens(-0.0225), .angles = [](double s) { return Angles{s, s, s}; }};
  const std::size_t creeps = static_cast<std::size_t>(std::distance(
      truth.site.markers.begin(), std::ranges::find(truth.site.markers, Role::kReference, &Marker::role)));
  const Footage run = footage_of(truth, 24, [=](std::size_t marker, int frame) -> Extent<frame::Board> {
    return {0.0, marker == creeps ? frame / 23.0 : 0.0};
  });
  const Calibration at_once =
      calibrate(truth.site, run.frames, scene_prior(truth.site, truth.camera.width, truth.camera.height, std::nullopt));
  const Shutter solved =
      solved_from(truth, test::series_of(run.frames), std::nullopt, nullptr, at_once.shutter.chi2_dof);
  EXPECT_FALSE(is_justified(solved, at_once))
      << "readout " << solved.readout_s << " s, u " << solved.u_readout_s << ", chi2/dof "
      << solved.calibration.shutter.chi2_dof << ", seed " << kFootageSeed;
}

// Returns the largest error of the target's displacement, in its u by noise and path.
double worst_in_u(const Recording& truth, const Shutter& solved, const Footage& run) {
  const std::size_t target = truth.site.markers.size() - 1;
  const auto& fits = solved.calibration.fits;
  double worst = 0.0;
  for (std::size_t k = 1; k < run.frames.size(); ++k) {
    const auto error = (fits[k].shift[target] - fits[0].shift[target]) - (run.shift[k] - run.shift[0]);
    const int row = fits[k].shift_row[target];
    const auto u = [&](int axis) { return std::sqrt(fits[k].variance(row + axis) + fits[0].variance(row + axis)); };
    worst = std::max({worst, std::abs(error.x) / u(0), std::abs(error.y) / u(1)});
  }
  return worst;
}

// To a camera that reads its rows one after another, prints with tilts look like a camera whose rotation accelerates
// during every readout. A camera that sways by only 0.1 deg before four references does not show its path well. A path
// that follows the tilts then absorbs them, chi2 stays high, and displacements follow the path. The limit is four u for
// 46 values.
TEST(SolveShutter, TiltsOfPrintsAreNoMotionOfTheCamera) {
  constexpr double kReadout = 0.020;  // s
  constexpr double kSway_deg = 0.1;
  Recording truth;
  truth.camera = lens(-0.0225);
  truth.readout_s = kReadout;
  truth.angles = [](double s) {
    return Angles{kSway_deg * s, kSway_deg * std::sin(9.0 * s), kSway_deg * std::sin(17.0 * s)};
  };
  truth.target = [](double s) { return Extent<frame::Board>{0.3 * std::sin(7.0 * s), 2.0 * s}; };
  std::mt19937_64 rng(kFootageSeed);
  std::normal_distribution<double> tilt(0.0, 0.004);
  for (std::size_t i = 0; i < truth.site.markers.size(); ++i) truth.tilt.push_back({tilt(rng), tilt(rng)});
  const Footage run = footage_of(truth, 24);
  const Shutter solved = solved_from(truth, run, kReadout);
  ASSERT_EQ(solved.problem, "");
  EXPECT_TRUE(solved.calibration.bundle.scene.model.tilts) << "seed " << kFootageSeed;
  // Before print error is allowed for.
  EXPECT_NEAR(solved.calibration.shutter.chi2_dof, 1.0, 0.15) << "seed " << kFootageSeed;
  EXPECT_LT(worst_in_u(truth, solved, run), 4.0) << "seed " << kFootageSeed;
}

// A target swings by 5 mm at 2 Hz. A rolling shutter shears its print by up to 4 mrad, half of which looks like a
// rotation. Its rotation has a prior of 0.1 mrad. Removed from frames as read, it would be missing where the shutter is
// solved.
TEST(SolveShutter, MovementsAreRemovedAtFrameTime) {
  constexpr double kReadout = 0.020;  // s
  const Recording truth{.site = test::rig_of_six(),
                        .camera = lens(-0.0225),
                        .angles = turning,
                        .readout_s = kReadout,
                        .target = [](double s) {
                          return Extent<frame::Board>{5.0 * std::sin(kTwoPi * 2.0 * s), 0.0};
                        }};
  const FrameSeries read = test::series_of(footage_of(truth, 24).frames);
  const std::size_t target = truth.site.markers.size() - 1;
  TargetMovements movements(truth.site.markers.size());
  movements[target].prior = {0.0, 0.0001, 0.0001, 0.0001};
  const auto removal =
      std::make_shared<const MovementRemoval>(truth.site, solved_from(truth, read, kReadout).calibration.bundle.scene,
                                              movements, std::vector<RotationCentre>(truth.site.markers.size()));
  // Before print error is allowed for.
  const auto chi2_dof = [](const Shutter& s) { return s.calibration.shutter.chi2_dof; };
  EXPECT_NEAR(chi2_dof(solved_from(truth, read, kReadout, removal)), 1.0, 0.15) << "seed " << kFootageSeed;
  EXPECT_GT(chi2_dof(solved_from(truth, only_displaced(read, removal), kReadout)), 1.15) << "seed " << kFootageSeed;
}

}  // namespace
}  // namespace moiregauge::internal
