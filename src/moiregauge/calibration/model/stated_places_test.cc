// SPDX-License-Identifier: Apache-2.0
// Tests that positions, angles and heights stated better than usual improve displacements, and that u stays true.
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "moiregauge/calibration/model/calibrate.h"
#include "moiregauge/calibration/model/travel_for_tests.h"

namespace moiregauge::internal {
namespace {

using test::drawn_from, test::kDepthMm, test::kDistanceMm, test::kIdeal, test::kMid, test::kPointNoise, test::kSurveyed,
    test::kTravelFrames, test::kTravelSeed, test::small_rig, test::Travel, test::TravelFootage, test::travelling;

struct Displacements {
  std::vector<Extent<frame::Board>> error, u;  // mm, one per frame after the first
  std::vector<Extent<frame::Board>> u_scene;   // the scene's part of u
  double u_focal = 0.0;                        // relative
  double u_height_mm = 0.0;                    // the target's
};

Displacements displacements_of(const TravelFootage& footage, const Site& site, const std::optional<Camera>& camera) {
  ScenePrior prior = scene_prior(site, kIdeal.width, kIdeal.height, camera);
  if (camera) prior.u_camera.fill(0.0);
  const Calibration solved = calibrate(site, footage.frames, prior);
  const Eigen::MatrixXd covariance = scene_covariance(site, solved.fits, solved.prior, kEverything);
  Displacements out;
  const int height = shape_row(kMid, MarkerShape::kHeight);
  out.u_focal = std::sqrt(covariance(0, 0)) / kIdeal.fx;
  out.u_height_mm = std::sqrt(covariance(height, height));
  const FrameFit& then = solved.fits.front();
  for (std::size_t k = 1; k < solved.fits.size(); ++k) {
    const FrameFit& now = solved.fits[k];
    const Eigen::MatrixXd by_scene = shift_sensitivity(now, kMid) - shift_sensitivity(then, kMid);
    const Eigen::Matrix2d scene = by_scene * covariance * by_scene.transpose();
    const Eigen::Matrix2d all = scene + shift_covariance(now, kMid) + shift_covariance(then, kMid);
    out.error.push_back(now.shift[kMid] - then.shift[kMid]);
    out.u.push_back({std::sqrt(all(0, 0)), std::sqrt(all(1, 1))});
    out.u_scene.push_back({std::sqrt(scene(0, 0)), std::sqrt(scene(1, 1))});
  }
  return out;
}

double mean_square(const std::vector<Extent<frame::Board>>& values) {
  double sum = 0.0;
  for (const auto& v : values) sum += v.x * v.x + v.y * v.y;
  return sum / (2.0 * static_cast<double>(values.size()));
}

// With the heights known, u is 0.6 of that of the usual statement, because the target's size then also shows the focal
// length. 16 runs with two or more independent errors each determine the ratio of two rms errors to 0.6 * 0.18.
TEST(StatedPlaces, ImproveTheDisplacementsOfTheSameFootage) {
  std::mt19937_64 rng(kTravelSeed);
  double usual_square = 0.0, surveyed_square = 0.0, normalised = 0.0;
  constexpr int kRuns = 16;
  for (int run = 0; run < kRuns; ++run) {
    const TravelFootage footage = travelling(drawn_from(kSurveyed, rng), rng);
    const auto usual = displacements_of(footage, small_rig(KnownTo{}), std::nullopt);
    const auto surveyed = displacements_of(footage, small_rig(kSurveyed, kDepthMm), std::nullopt);
    // Information adds up, so a better statement cannot enlarge u. The scenes differ, which changes it by a few per cent.
    EXPECT_LT(mean_square(surveyed.u), 1.05 * mean_square(usual.u)) << "run " << run << ", seed " << kTravelSeed;
    usual_square += mean_square(usual.error), surveyed_square += mean_square(surveyed.error);
    normalised += mean_square(surveyed.error) / mean_square(surveyed.u);
  }
  EXPECT_LT(std::sqrt(surveyed_square / usual_square), 0.6 + 2.0 * 0.6 * 0.18) << "seed " << kTravelSeed;
  // The rms of 32 independent normalised errors has a standard error of 1 / sqrt(64). Four of them are allowed.
  EXPECT_NEAR(std::sqrt(normalised / kRuns), 1.0, 0.5) << "seed " << kTravelSeed;
}

// A focal length wrong by the share e makes the distance wrong by e, and the direction of a rotated camera by 2 e. The
// target is z off the plane, so its displacement is wrong by e z (t / Z + 2 turn).
TEST(StatedPlaces, LeaveTheErrorOfTheFocalLengthTimesTheParallax) {
  std::mt19937_64 rng(kTravelSeed);
  const TravelFootage footage = travelling(drawn_from(kSurveyed, rng), rng);
  const auto surveyed = displacements_of(footage, small_rig(kSurveyed, kDepthMm), std::nullopt);
  std::vector<Extent<frame::Board>> expected;
  const Travel& then = footage.camera.front();
  for (std::size_t k = 1; k < footage.camera.size(); ++k) {
    const Travel& now = footage.camera[k];
    const double along_x = (now.mm.x() - then.mm.x()) / kDistanceMm + 2.0 * (now.turn_y_rad - then.turn_y_rad);
    const double along_y = (now.mm.y() - then.mm.y()) / kDistanceMm - 2.0 * (now.turn_x_rad - then.turn_x_rad);
    expected.push_back({kDepthMm * surveyed.u_focal * along_x, kDepthMm * surveyed.u_focal * along_y});
  }
  // The other parameters add a twentieth of the variance.
  EXPECT_NEAR(std::sqrt(mean_square(surveyed.u_scene) / mean_square(expected)), 1.0, 0.15) << "seed " << kTravelSeed;
}

// The height z is not stated. The target's apparent size in board coordinates is 1 + z / Z, and Z changes from frame to
// frame. The noise of that size follows from nine points at 0 and +-w / 3: it is noise / (sqrt(12) w / 3).
TEST(StatedPlaces, WithoutAHeightApparentSizeDeterminesIt) {
  std::mt19937_64 rng(kTravelSeed);
  const TravelFootage footage = travelling(drawn_from(kSurveyed, rng), rng);
  const auto solved = displacements_of(footage, small_rig(kSurveyed), kIdeal);
  double mean = 0.0, square = 0.0;
  for (const Travel& t : footage.camera) mean += 1.0 / (kDistanceMm + t.mm.z()) / kTravelFrames;
  for (const Travel& t : footage.camera) square += std::pow(1.0 / (kDistanceMm + t.mm.z()) - mean, 2);
  const double u_size = kPointNoise * test::kPitch / (std::sqrt(12.0) * 40.0 / 3.0);
  // The references' noise adds to that of the target.
  EXPECT_NEAR(solved.u_height_mm / (u_size / std::sqrt(square)), 1.0, 0.1) << "seed " << kTravelSeed;
}

}  // namespace
}  // namespace moiregauge::internal
