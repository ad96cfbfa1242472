// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/model/target_movement.h"

#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "moiregauge/calibration/model/calibrate.h"
#include "moiregauge/calibration/scene/footage_for_tests.h"
#include "moiregauge/calibration/scene/frame_pose.h"

namespace moiregauge::internal {
namespace {

using test::Footage, test::Recording;

constexpr int kFramesOfRotation = 24;
constexpr std::size_t kTarget = 6;  // after six references

Recording rotating_rig() {
  return {.site = test::rig_of_six(), .camera = test::lens(-0.0225), .angles = test::swinging(3.0)};
}

// Returns the target's rotation at a time, rad.
Eigen::Vector3d rotation_at(double s, double strength_rad) {
  return strength_rad * Eigen::Vector3d(0.7 * std::sin(4.0 * s), 0.5 * std::cos(3.0 * s), std::sin(6.0 * s + 0.4));
}

// Returns the target's height at a time, mm.
double height_at(double s, double strength_mm) { return strength_mm * std::sin(5.0 * s); }

// Returns a second of footage in which the target also rotates, about a point `about_mm` from the middle of its
// grating, and leaves its plane.
Footage rotating_footage(const Recording& truth, double strength_rad, Extent<frame::Board> about_mm = {},
                         double height_mm = 0.0) {
  Footage run = test::footage_of(truth, kFramesOfRotation);
  std::mt19937_64 rng(test::kFootageSeed);
  const Grating& grating = *truth.site.markers[kTarget].grating;
  for (std::size_t k = 0; k < run.frames.size(); ++k) {
    const double s = run.frames[k].time_s;
    const Eigen::Vector3d by = rotation_at(s, strength_rad);
    const Eigen::AngleAxisd rotation(by.norm(), by.norm() > 0.0 ? by.normalized() : Eigen::Vector3d::UnitZ());
    PatchFit& fit = *run.frames[k].points[kTarget];
    for (int n = 0; n < kPatchPoints; ++n) {
      const Eigen::Vector3d arm((n % 3 - 1) * grating.width_mm / 3.0 - about_mm.x,
                                (n / 3 - 1) * grating.height_mm / 3.0 - about_mm.y, 0.0);
      const Eigen::Vector3d there = rotation * arm;
      const View view{test::seen_from(truth.camera, truth.angles(s), there.z() + height_at(s, height_mm)),
                      truth.camera};
      fit.image[static_cast<std::size_t>(n)] =
          view(grating.centre + run.shift[k] + about_mm + Extent<frame::Board>{there.x(), there.y()});
    }
  }
  return run;
}

Calibration solved(const Recording& truth, const std::vector<BundleFrame>& frames) {
  return calibrate(truth.site, frames, scene_prior(truth.site, truth.camera.width, truth.camera.height, std::nullopt));
}

std::vector<BundleFrame> placed(const Recording& truth, const Scene& scene, std::vector<BundleFrame> frames) {
  for (BundleFrame& frame : frames) frame.pose = pose_of(truth.site, scene, frame).value_or(frame.pose);
  return frames;
}

// Removes the movements that the footage shows, as `precise` does: repeatedly, because they bend the
// first scene.
Calibration solved_without_movements(const Recording& truth, const std::vector<BundleFrame>& frames,
                                     RotationCentre centre = {}) {
  Calibration calibration = solved(truth, frames);
  const TargetMovements movements =
      find_movements(truth.site, calibration.bundle.scene, placed(truth, calibration.bundle.scene, frames));
  EXPECT_FALSE(movements.empty());
  for (int round = 0; round < 5 && !movements.empty(); ++round) {
    const MovementRemoval removal(truth.site, calibration.bundle.scene, movements,
                                  std::vector(truth.site.markers.size(), centre));
    std::vector<BundleFrame> displaced_only;
    for (const BundleFrame& frame : frames) displaced_only.push_back(removal.displaced_only(frame));
    calibration = solved(truth, displaced_only);
  }
  return calibration;
}

// Returns the largest error of the target's displacement, mm.
double worst_error_mm(const Recording& truth, const Calibration& calibration, const Footage& run) {
  const auto shift_in = [&](std::size_t k) {
    const FrameFit fit = fit_frame(truth.site, calibration.bundle.scene, calibration.bundle.frames[k]);
    EXPECT_TRUE(fit.ok);
    return fit.shift[kTarget];
  };
  double worst = 0.0;
  for (std::size_t k = 1; k < run.frames.size(); ++k) {
    const auto error = (shift_in(k) - shift_in(0)) - (run.shift[k] - run.shift[0]);
    worst = std::max({worst, std::abs(error.x), std::abs(error.y)});
  }
  return worst;
}

// Noise of 2 um for each of nine points gives 2 um / 3 sqrt(1 + 1/6) sqrt(2) = 1.02 um. The limit is four times that,
// for 46 values. With rotations of 20 mrad the edges of the print, 20 mm from its middle, are 0.4 mm off, 200 times the
// noise.
TEST(TargetMovement, DoesNotChangeTheDisplacement) {
  const Recording truth = rotating_rig();
  const Footage run = rotating_footage(truth, 0.020);
  const Calibration bent = solved(truth, run.frames);
  EXPECT_GT(bent.print_error.targets_mm[kTarget], 0.05) << "a rotation counts as print error";
  const Calibration calibration = solved_without_movements(truth, run.frames);
  ASSERT_TRUE(calibration.bundle.scene.solved) << calibration.bundle.scene.problem;
  EXPECT_FALSE(calibration.print_error.exceeds_noise()) << "seed " << test::kFootageSeed;
  EXPECT_NEAR(calibration.bundle.scene.chi2_dof, 1.0, 0.15) << "seed " << test::kFootageSeed;
  EXPECT_LT(worst_error_mm(truth, calibration, run), 4.1e-3) << "seed " << test::kFootageSeed;
}

// The print rotates about a point 4 mm from its middle. Displacement is that of this point only if it is known. An arm
// of 4 mm and 20 mrad would give an error of 0.08 mm.
TEST(TargetMovement, DisplacementIsThatOfTheCentre) {
  const Recording truth = rotating_rig();
  const Extent<frame::Board> about{4.0, -3.0};
  const Footage run = rotating_footage(truth, 0.020, about);
  const RotationCentre centre{{about.x / test::kPitch, about.y / test::kPitch}, 0.0};
  EXPECT_LT(worst_error_mm(truth, solved_without_movements(truth, run.frames, centre), run), 4.1e-3)
      << "seed " << test::kFootageSeed;
  EXPECT_GT(worst_error_mm(truth, solved_without_movements(truth, run.frames), run), 0.05);
}

// An uncertain centre adds its u times the change of the rotation in the plane.
TEST(TargetMovement, AnUncertainCentreIsInTheUncertainty) {
  const Recording truth = rotating_rig();
  const Footage run = rotating_footage(truth, 0.020);
  const Calibration calibration = solved(truth, run.frames);
  TargetMovements movements(truth.site.markers.size());
  movements[kTarget].prior = {0.0, 0.05, 0.05, 0.05};
  const MovementRemoval removal(truth.site, calibration.bundle.scene, movements,
                                std::vector(truth.site.markers.size(), RotationCentre{{}, 0.5}));
  const BundleFrame then = removal.displaced_only(run.frames[0]), now = removal.displaced_only(run.frames[6]);
  const double turned = rotation_at(run.frames[6].time_s, 0.020).z() - rotation_at(0.0, 0.020).z();
  EXPECT_NEAR(removal.u_beyond_noise(kTarget, now, then).x, 0.5 * std::abs(turned),
              0.1 * 0.5 * std::abs(turned));  // in the first, bent scene
  EXPECT_EQ(removal.u_beyond_noise(0, now, then).x, 0.0) << "a reference";
}

// Returns the rig with its target at the right edge, 230 mm from the middle: the line of sight is oblique by 0.19.
Recording rig_with_target_aside() {
  Recording truth = rotating_rig();
  truth.site.markers[kTarget].grating->centre = {230.0, 0.0};
  return truth;
}

// A height of 3 mm appears as a displacement of 0.19 times that, 0.58 mm. The nine points are 20 mm apart and show the
// size of the print to 2 um / sqrt(4800 mm^2). At 1200 mm that is a height of 35 um. Its displacement is therefore known to
// 0.19 * 35 um * sqrt(2) = 9.4 um. The limit is four times that.
TEST(TargetMovement, AHeightDoesNotChangeTheDisplacement) {
  const Recording truth = rig_with_target_aside();
  const Footage run = rotating_footage(truth, 0.0, {}, 3.0);
  EXPECT_GT(worst_error_mm(truth, solved(truth, run.frames), run), 0.2) << "without the removal";
  const Calibration calibration = solved_without_movements(truth, run.frames);
  EXPECT_FALSE(calibration.print_error.exceeds_noise()) << "seed " << test::kFootageSeed;
  EXPECT_LT(worst_error_mm(truth, calibration, run), 0.038) << "seed " << test::kFootageSeed;
}

// The variance of a displacement contains that of the height. All errors share that of the reference frame. The mean
// square of error over u is therefore between 0.3 and 3 in all but a few of a thousand draws.
TEST(TargetMovement, TheUncertaintyContainsThatOfTheHeight) {
  const Recording truth = rig_with_target_aside();
  const Footage run = rotating_footage(truth, 0.0, {}, 3.0);
  const Calibration calibration = solved_without_movements(truth, run.frames);
  const FrameFit& then = calibration.fits.front();
  const int row = then.shift_row[kTarget];
  double sum = 0.0;
  for (std::size_t k = 1; k < run.frames.size(); ++k) {
    const FrameFit& now = calibration.fits[k];
    const double error = (now.shift[kTarget].x - then.shift[kTarget].x) - (run.shift[k].x - run.shift[0].x);
    sum += error * error / (now.variance(row) + then.variance(row));
    EXPECT_GT(std::sqrt(now.variance(row)), 0.005) << "without the height it is 1 um";
  }
  const double mean = sum / static_cast<double>(run.frames.size() - 1);
  EXPECT_GT(mean, 0.3) << "seed " << test::kFootageSeed;
  EXPECT_LT(mean, 3.0) << "seed " << test::kFootageSeed;
}

// Noise alone is no movement. A step of 3 mm towards the camera is no rotation. It makes a target that is seen from the
// side longer, like a tilt.
TEST(TargetMovement, NoiseIsNoneAndAHeightIsNoRotation) {
  const Recording truth = rig_with_target_aside();
  const Footage still = test::footage_of(truth, kFramesOfRotation);
  const auto found_in = [&](const std::vector<BundleFrame>& frames) {
    const Scene scene = solved(truth, frames).bundle.scene;
    return find_movements(truth.site, scene, placed(truth, scene, frames));
  };
  EXPECT_TRUE(found_in(still.frames).empty()) << "seed " << test::kFootageSeed;
  Recording near = truth;
  near.height_mm.assign(truth.site.markers.size(), 0.0);
  near.height_mm[kTarget] = 3.0;
  const Footage raised = test::footage_of(near, kFramesOfRotation);
  std::vector<BundleFrame> moving = still.frames;
  for (std::size_t k = kFramesOfRotation / 2; k < kFramesOfRotation; ++k) moving[k] = raised.frames[k];
  const TargetMovements found = found_in(moving);
  ASSERT_FALSE(found.empty()) << "seed " << test::kFootageSeed;
  EXPECT_TRUE(found[kTarget].leaves_plane());
  EXPECT_FALSE(found[kTarget].rotates());
}

}  // namespace
}  // namespace moiregauge::internal
