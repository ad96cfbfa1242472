// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/model/target_rotation.h"

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
Rotation3 rotation_at(double s, double strength_rad) {
  return strength_rad * Rotation3(0.7 * std::sin(4.0 * s), 0.5 * std::cos(3.0 * s), std::sin(6.0 * s + 0.4));
}

// Returns a second of footage in which the target also rotates, about a point `about_mm` from the middle of its
// grating.
Footage rotating_footage(const Recording& truth, double strength_rad, Extent<frame::Board> about_mm = {}) {
  Footage run = test::footage_of(truth, kFramesOfRotation);
  std::mt19937_64 rng(test::kFootageSeed);
  const Grating& grating = *truth.site.markers[kTarget].grating;
  for (std::size_t k = 0; k < run.frames.size(); ++k) {
    const double s = run.frames[k].time_s;
    const Rotation3 by = rotation_at(s, strength_rad);
    const Eigen::AngleAxisd rotation(by.norm(), by.norm() > 0.0 ? by.normalized() : Rotation3::UnitZ());
    PatchFit& fit = *run.frames[k].points[kTarget];
    for (int n = 0; n < kPatchPoints; ++n) {
      const Eigen::Vector3d arm((n % 3 - 1) * grating.width_mm / 3.0 - about_mm.x,
                                (n / 3 - 1) * grating.height_mm / 3.0 - about_mm.y, 0.0);
      const Eigen::Vector3d there = rotation * arm;
      const View view{test::seen_from(truth.camera, truth.angles(s), there.z()), truth.camera};
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

// Removes the rotations that the footage shows, as `precise` does: twice, because they bend the first scene.
Calibration solved_without_rotations(const Recording& truth, const std::vector<BundleFrame>& frames,
                                     RotationCentre centre = {}) {
  Calibration calibration = solved(truth, frames);
  const TargetRotations rotations =
      find_rotations(truth.site, calibration.bundle.scene, placed(truth, calibration.bundle.scene, frames));
  EXPECT_FALSE(rotations.empty());
  for (int round = 0; round < 2 && !rotations.empty(); ++round) {
    const RotationRemoval removal(truth.site, calibration.bundle.scene, rotations,
                                  std::vector(truth.site.markers.size(), centre));
    std::vector<BundleFrame> unrotated;
    for (const BundleFrame& frame : frames) unrotated.push_back(removal.unrotated(frame));
    calibration = solved(truth, unrotated);
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
TEST(TargetRotation, DoesNotChangeTheDisplacement) {
  const Recording truth = rotating_rig();
  const Footage run = rotating_footage(truth, 0.020);
  const Calibration bent = solved(truth, run.frames);
  EXPECT_GT(bent.print_error.points_mm, 0.05) << "a rotation counts as print error";
  const Calibration calibration = solved_without_rotations(truth, run.frames);
  ASSERT_TRUE(calibration.bundle.scene.solved) << calibration.bundle.scene.problem;
  EXPECT_DOUBLE_EQ(calibration.print_error.points_mm, 0.0) << "seed " << test::kFootageSeed;
  EXPECT_NEAR(calibration.bundle.scene.chi2_dof, 1.0, 0.15) << "seed " << test::kFootageSeed;
  EXPECT_LT(worst_error_mm(truth, calibration, run), 4.1e-3) << "seed " << test::kFootageSeed;
}

// The print rotates about a point 4 mm from its middle. Displacement is that of this point only if it is known. An arm
// of 4 mm and 20 mrad would give an error of 0.08 mm.
TEST(TargetRotation, DisplacementIsThatOfTheCentre) {
  const Recording truth = rotating_rig();
  const Extent<frame::Board> about{4.0, -3.0};
  const Footage run = rotating_footage(truth, 0.020, about);
  const RotationCentre centre{{about.x / test::kPitch, about.y / test::kPitch}, 0.0};
  EXPECT_LT(worst_error_mm(truth, solved_without_rotations(truth, run.frames, centre), run), 4.1e-3)
      << "seed " << test::kFootageSeed;
  EXPECT_GT(worst_error_mm(truth, solved_without_rotations(truth, run.frames), run), 0.05);
}

// An uncertain centre adds its u times the change of the rotation in the plane.
TEST(TargetRotation, AnUncertainCentreIsInTheUncertainty) {
  const Recording truth = rotating_rig();
  const Footage run = rotating_footage(truth, 0.020);
  const Calibration calibration = solved(truth, run.frames);
  TargetRotations rotations(truth.site.markers.size());
  rotations[kTarget].prior_rad = Rotation3::Constant(0.05);
  const RotationRemoval removal(truth.site, calibration.bundle.scene, rotations,
                                std::vector(truth.site.markers.size(), RotationCentre{{}, 0.5}));
  const BundleFrame then = removal.unrotated(run.frames[0]), now = removal.unrotated(run.frames[6]);
  const double turned = rotation_at(run.frames[6].time_s, 0.020).z() - rotation_at(0.0, 0.020).z();
  EXPECT_NEAR(removal.u_by_centre(kTarget, now, then), 0.5 * std::abs(turned),
              0.1 * 0.5 * std::abs(turned));  // in the first, bent scene
  EXPECT_EQ(removal.u_by_centre(0, now, then), 0.0) << "a reference";
}

// Noise alone is no rotation. A movement of 3 mm towards the camera is none either. It makes a target that is seen from
// the side longer, like a tilt.
TEST(TargetRotation, NoiseAndAMovementTowardsTheCameraAreNone) {
  Recording truth = rotating_rig();
  truth.site.markers[kTarget].grating->centre = {230.0, 0.0};
  const Footage still = test::footage_of(truth, kFramesOfRotation);
  truth.height_mm.assign(truth.site.markers.size(), 0.0);
  truth.height_mm[kTarget] = 3.0;
  const Footage raised = test::footage_of(truth, kFramesOfRotation);
  std::vector<BundleFrame> moving = still.frames;
  for (std::size_t k = kFramesOfRotation / 2; k < kFramesOfRotation; ++k) moving[k] = raised.frames[k];
  for (const auto& frames : {still.frames, moving}) {
    const Scene scene = solved(truth, frames).bundle.scene;
    EXPECT_TRUE(find_rotations(truth.site, scene, placed(truth, scene, frames)).empty())
        << "seed " << test::kFootageSeed;
  }
}

}  // namespace
}  // namespace moiregauge::internal
