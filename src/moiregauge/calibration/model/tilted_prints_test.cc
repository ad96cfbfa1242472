// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "moiregauge/calibration/model/calibrate.h"
#include "moiregauge/calibration/scene/footage_for_tests.h"

namespace moiregauge::internal {
namespace {

using test::Footage, test::Recording;

constexpr int kFramesOfTilts = 24;
constexpr std::size_t kTiltedTarget = 6;  // after six references

// Every print is mounted with tilts of this rms about both axes.
Recording mounted_with(double rms_rad) {
  Recording truth{.site = test::rig_of_six(), .camera = test::lens(-0.0225), .angles = test::swinging(3.0)};
  std::mt19937_64 rng(test::kFootageSeed);
  std::normal_distribution<double> tilt(0.0, rms_rad);
  for (std::size_t i = 0; rms_rad > 0.0 && i < truth.site.markers.size(); ++i)
    truth.tilt.push_back({tilt(rng), tilt(rng)});
  return truth;
}

Calibration solved_as_seen(const Recording& truth, const Footage& run) {
  return calibrate(truth.site, run.frames,
                   scene_prior(truth.site, truth.camera.width, truth.camera.height, std::nullopt));
}

// Noise of 2 um for each of nine points gives 2 um / 3 sqrt(1 + 1/6) sqrt(2) = 1.02 um. The limit is four times that,
// for 46 values. With tilts of 10 mrad the edges of a print are 0.2 mm out of the plane. That is 4 um of perspective,
// and 10 um when the camera has rotated by 3 deg.
TEST(TiltedPrints, DoNotChangeTheDisplacement) {
  const Recording truth = mounted_with(0.010);
  const Footage run = test::footage_of(truth, kFramesOfTilts);
  const Calibration calibration = solved_as_seen(truth, run);
  const Scene& scene = calibration.bundle.scene;
  ASSERT_TRUE(scene.solved) << scene.problem;
  EXPECT_TRUE(scene.model.tilts) << scene.model.name();
  EXPECT_FALSE(calibration.print_error.exceeds_noise()) << "seed " << test::kFootageSeed;
  EXPECT_NEAR(scene.chi2_dof, 1.0, 0.15) << "seed " << test::kFootageSeed;
  const FrameFit& then = calibration.fits.front();
  for (std::size_t k = 1; k < run.frames.size(); ++k) {
    const auto error =
        (calibration.fits[k].shift[kTiltedTarget] - then.shift[kTiltedTarget]) - (run.shift[k] - run.shift[0]);
    EXPECT_LT(std::max(std::abs(error.x), std::abs(error.y)), 4.1e-3)
        << "frame " << k << ", seed " << test::kFootageSeed;
  }
}

// The sum of squares of 14 independent errors in their u is 14 +- 5.3. The limit is three standard deviations more. A
// common tilt of all prints is hardly known, because heights within their prior also tilt this narrow layout.
TEST(TiltedPrints, TiltsAreRightWithinTheirUncertainty) {
  const Recording truth = mounted_with(0.010);
  const Scene scene = solved_as_seen(truth, test::footage_of(truth, kFramesOfTilts)).bundle.scene;
  std::vector<int> rows;
  Eigen::VectorXd error(2 * static_cast<Eigen::Index>(truth.tilt.size()));
  for (std::size_t i = 0; i < truth.tilt.size(); ++i) {
    for (const auto& [k, tilt] :
         {std::pair{MarkerShape::kTiltX, truth.tilt[i].x}, {MarkerShape::kTiltY, truth.tilt[i].y}}) {
      error(static_cast<Eigen::Index>(rows.size())) = scene.markers[i].value[k] - tilt;
      rows.push_back(shape_row(i, k));
    }
  }
  const Eigen::MatrixXd covariance = scene.covariance(rows, rows);
  EXPECT_LT(error.dot(covariance.ldlt().solve(error)), 30.0) << "seed " << test::kFootageSeed;
  for (const Eigen::Index axis : {0, 1}) {
    const double of_difference =
        covariance(axis, axis) + covariance(axis + 2, axis + 2) - 2.0 * covariance(axis, axis + 2);
    EXPECT_LT(std::sqrt(of_difference), 0.005) << "half the tilts, between two prints";
  }
}

// Prints that lean towards the middle by 50 mrad look narrower, by 50 mrad times the slope of the line of sight. At 130 mm
// from the axis of this camera that is 0.5 %, ten times the u of the print scale. It is no stretch of the paper, so the
// scales are as well known as stated.
TEST(TiltedPrints, DoNotLookStretched) {
  Recording truth = mounted_with(0.0);
  for (const Marker& marker : truth.site.markers)
    truth.tilt.push_back({0.0, marker.grating->centre.x < 0.0 ? 0.05 : -0.05});
  const Calibration calibration = solved_as_seen(truth, test::footage_of(truth, kFramesOfTilts));
  const Scene& scene = calibration.bundle.scene;
  EXPECT_TRUE(scene.model.tilts) << scene.model.name() << ", seed " << test::kFootageSeed;
  EXPECT_FALSE(calibration.stretched) << scene.stretch;
  for (const MarkerShape& u : calibration.prior.u_markers)
    EXPECT_EQ(u.value[MarkerShape::kScale], truth.site.known_to.print_scale) << "seed " << test::kFootageSeed;
}

// BIC accepts parameters without need about once in a thousand runs or less.
TEST(TiltedPrints, PrintsInOnePlaneHaveNone) {
  const Recording truth = mounted_with(0.0);
  const Scene scene = solved_as_seen(truth, test::footage_of(truth, kFramesOfTilts)).bundle.scene;
  EXPECT_FALSE(scene.model.tilts) << scene.model.name() << ", seed " << test::kFootageSeed;
}

// Mounted by eye, tilts have a u of 0.05 rad. With 0.15 rad their sum of squares is 126 u^2 for 14 tilts, and chance
// exceeds 36 once in a thousand sites. The residuals are then print error.
TEST(TiltedPrints, LargerTiltsThanOfMountedPrintsAreAnotherFault) {
  const Recording truth = mounted_with(0.15);
  const Calibration calibration = solved_as_seen(truth, test::footage_of(truth, kFramesOfTilts));
  EXPECT_FALSE(calibration.bundle.scene.model.tilts) << "seed " << test::kFootageSeed;
  EXPECT_TRUE(calibration.print_error.has_rough_prints()) << "seed " << test::kFootageSeed;
}

}  // namespace
}  // namespace moiregauge::internal
