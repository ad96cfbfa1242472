// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/model/persistent_error.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "moiregauge/calibration/scene/footage_for_tests.h"

namespace moiregauge::internal {
namespace {

constexpr int kPersistentFrames = 24, kPersistentTrials = 30;
constexpr double kPersistent_mm = 0.005;  // 1.8 times the noise of a point in one frame

// Footage of rough prints: every point has an error of its own, and one in common with its print, the same in all frames.
struct RoughPrints {
  test::Recording truth{.site = test::rig_of_six(), .camera = test::lens(-0.0225), .angles = test::swinging(3.0)};
  std::vector<BundleFrame> frames = test::footage_of(truth, kPersistentFrames).frames;

  explicit RoughPrints(std::mt19937_64& rng, double error_mm = kPersistent_mm) {
    std::normal_distribution<double> error(0.0, error_mm);
    // More noise is drawn, because footage_of() repeats its own.
    std::normal_distribution<double> noise(0.0, test::kNoise);
    for (std::size_t i = 0; i < truth.site.markers.size(); ++i) {
      const double pitch_mm = truth.site.markers[i].grating->pitch_mm;
      const PrintPoint common{error(rng) / pitch_mm, error(rng) / pitch_mm};
      for (std::size_t n = 0; n < kPatchPoints; ++n) {
        const PrintPoint own{common.x + error(rng) / pitch_mm, common.y + error(rng) / pitch_mm};
        for (BundleFrame& frame : frames) {
          PrintPoint& point = frame.points[i]->print[n];
          point = {point.x + own.x + noise(rng), point.y + own.y + noise(rng)};
          frame.points[i]->information = PatchInformation::Identity() / (2.0 * test::kNoise * test::kNoise);
        }
      }
    }
  }
  [[nodiscard]] Calibration solved() const {
    return calibrate(truth.site, frames,
                     scene_prior(truth.site, truth.camera.width, truth.camera.height, std::nullopt));
  }
};

// The mean of 30 squares of f's error in u is 1 +- 0.26. The limit is four standard deviations more. By the noise of 24
// frames the same errors are beyond it, because the roughness of a print does not average out.
TEST(PersistentError, TheFocalLengthIsWithinItsUncertainty) {
  std::mt19937_64 rng(test::kFootageSeed);
  double squares = 0.0, by_noise = 0.0;
  for (int k = 0; k < kPersistentTrials; ++k) {
    const RoughPrints prints(rng);
    const Calibration solved = prints.solved();
    ASSERT_TRUE(solved.bundle.scene.solved);
    const SceneModel model = everything_with(solved.bundle.scene.model);
    const double off = solved.bundle.scene.camera.fx - prints.truth.camera.fx;
    squares += off * off / covariance_with_persistent_errors(prints.truth.site, solved, model)(0, 0);
    by_noise += off * off / scene_covariance(prints.truth.site, solved.fits, solved.prior, model)(0, 0);
  }
  EXPECT_LT(squares / kPersistentTrials, 2.05) << "seed " << test::kFootageSeed;
  EXPECT_GT(squares / kPersistentTrials, 0.2) << "seed " << test::kFootageSeed;
  EXPECT_GT(by_noise / kPersistentTrials, 2.05) << "seed " << test::kFootageSeed;
}

// Some 60 of the 108 coordinates of six prints remain after the solution. So an estimate has a standard deviation of 9 %,
// and the mean of 30 one of 1.7 %. Parts in common to a print are mostly solved as its place.
TEST(PersistentError, IsFoundAsLargeAsItIs) {
  std::mt19937_64 rng(test::kFootageSeed);
  double sum = 0.0, without = 0.0;
  for (int k = 0; k < kPersistentTrials; ++k) {
    const auto error_mm = [](const RoughPrints& prints) {
      const Calibration solved = prints.solved();
      return persistent_error_mm(
          prints.truth.site, solved.bundle, solved.fits,
          scene_covariance(prints.truth.site, solved.fits, solved.prior, solved.bundle.scene.model));
    };
    sum += error_mm(RoughPrints(rng)) / kPersistentTrials;
    without += error_mm(RoughPrints(rng, 0.0)) / kPersistentTrials;
  }
  EXPECT_NEAR(sum, kPersistent_mm, 0.15 * kPersistent_mm) << "seed " << test::kFootageSeed;
  // Noise of 2.8 um, averaged over 24 frames, is 0.6 um. Its own scatter is left, on average less than half of it.
  EXPECT_LT(without, 0.3e-3) << "seed " << test::kFootageSeed;
}

// Only what differs from frame to frame counts. That is 1 for noise, also with roughness of 1.8 times the noise. A
// movement of one reference that alternates by six times the noise of a point counts.
TEST(PersistentError, DoesNotVary) {
  std::mt19937_64 rng(test::kFootageSeed);
  RoughPrints prints(rng);
  const auto varying = [&] {
    const ScenePrior prior =
        scene_prior(prints.truth.site, prints.truth.camera.width, prints.truth.camera.height, std::nullopt);
    const Calibration solved = calibrate(prints.truth.site, prints.frames, prior, {.print_error = false});
    return chi2_dof_of_places(prints.truth.site, {solved.bundle.scene, prints.frames}, solved.fits);
  };
  // 24 frames have 6 x 6 - 6 degrees of freedom each: 1 +- 0.053. Four standard deviations.
  EXPECT_NEAR(varying(), 1.0, 0.21) << "seed " << test::kFootageSeed;
  for (std::size_t k = 0; k < prints.frames.size(); k += 2) {
    for (PrintPoint& point : prints.frames[k].points.front()->print) point.x += 6.0 * test::kNoise;
  }
  // Nine points by +- 3 / sqrt(2) of their noise are 40 of chi2 in each frame, for 30 degrees of freedom. The pose takes
  // about half of it, which leaves 1.7. The limit is beyond four standard deviations of noise.
  EXPECT_GT(varying(), 1.3) << "seed " << test::kFootageSeed;
}

}  // namespace
}  // namespace moiregauge::internal
