// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/model/print_error.h"

#include <random>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include "moiregauge/calibration/model/marker_jitter.h"
#include "moiregauge/calibration/scene/patch_residual.h"
#include "moiregauge/calibration/scene/rig_for_tests.h"

namespace moiregauge::internal {
namespace {

using test::kPitch;

constexpr double kNoise_mm = 1e-3;
constexpr std::uint64_t kPrintSeed = 11;  // printed with every failure

struct Truth {
  Site site;
  Scene scene;
  ScenePrior prior;
};

Truth truth() {
  Truth t;
  for (const BoardPoint at : {BoardPoint{-300, 150}, {300, 150}, {-300, -150}, {300, -150}, {0, 0}}) {
    Marker m;
    m.role = at.x == 0.0 ? Role::kTarget : Role::kReference;
    m.grating = Grating{at, 60.0, 60.0, kPitch, 0.0, Pattern::kGrid};
    t.site.markers.push_back(m);
  }
  t.scene.camera = {2000, 1500, 2500, 2500, 1000, 750, -0.05, 0, 0, 0, 0};
  t.scene.markers.resize(t.site.markers.size());
  t.scene.model = {.radial = true};
  t.prior = scene_prior(t.site, 2000, 1500, std::nullopt);
  return t;
}

// Nine points of every grating, with their own noise, an error in each and an error common to all nine.
std::vector<BundleFrame> views(const Truth& t, double error_mm, double common_mm, int count = 12) {
  std::mt19937_64 rng(kPrintSeed);
  std::normal_distribution<double> normal;
  const Camera& c = t.scene.camera;
  const double camera[]{c.fx, c.cx, c.cy, c.k1, c.k2, c.p1, c.p2, c.k3};
  std::vector<BundleFrame> frames;
  for (int k = 0; k < count; ++k) {
    BundleFrame frame;
    frame.pose = {{0.2 * normal(rng), 0.2 * normal(rng), 0.2 * normal(rng)}, {0, 0, 1200}};
    for (const Marker& m : t.site.markers) {
      PatchFit fit;
      const double common[]{common_mm * normal(rng), common_mm * normal(rng)};
      for (std::size_t n = 0; n < kPatchPoints; ++n) {
        const double x = 20.0 * (static_cast<double>(n % 3) - 1.0), y = 20.0 * (static_cast<double>(n / 3) - 1.0);
        const double pose[]{frame.pose.turn[0],  frame.pose.turn[1],  frame.pose.turn[2],
                            frame.pose.shift[0], frame.pose.shift[1], frame.pose.shift[2]};
        const auto image = projected(camera, pose, {m.grating->centre.x + x, m.grating->centre.y + y, 0.0});
        fit.image[n] = {image[0], image[1]};
        fit.print[n] = {(x + common[0] + error_mm * normal(rng) + kNoise_mm * normal(rng)) / kPitch,
                        (y + common[1] + error_mm * normal(rng) + kNoise_mm * normal(rng)) / kPitch};
      }
      fit.information = PatchInformation::Identity() * (kPitch * kPitch) / (kNoise_mm * kNoise_mm);
      frame.points.emplace_back(fit);
      frame.shift.push_back({});
    }
    frames.push_back(frame);
  }
  return frames;
}

// Prior that fixes the scene at the truth: nothing was solved from these frames.
ScenePrior known(const Truth& t) {
  ScenePrior prior = t.prior;
  for (double& u : prior.u_camera) u = 1e-12;
  for (MarkerShape& u : prior.u_markers) u.value = {};
  return prior;
}

std::vector<FrameFit> fits_of(const Truth& t, const std::vector<BundleFrame>& frames) {
  std::vector<FrameFit> fits;
  for (const BundleFrame& frame : frames) fits.push_back(fit_frame(t.site, t.scene, frame));
  return fits;
}

PrintError estimate(const Truth& t, const std::vector<BundleFrame>& frames) {
  return print_error(t.site, t.scene, frames, fits_of(t, frames), known(t));
}

// The same print error for all prints.
PrintError everywhere(const Truth& t, double error_mm) {
  return {.references_mm = error_mm, .targets_mm = std::vector(t.site.markers.size(), error_mm)};
}

double wander(const Truth& t, const std::vector<BundleFrame>& frames, double already = 0.0) {
  return marker_jitter_mm(t.site, {t.scene, frames}, fits_of(t, frames), known(t), already);
}

TEST(PrintError, IsZeroForAPerfectGrating) {
  const Truth t = truth();
  EXPECT_FALSE(estimate(t, views(t, 0.0, 0.0)).exceeds_noise()) << "seed " << kPrintSeed;
}

// Four references in twelve views: 792 degrees of freedom determine a scatter to 1 / sqrt(2 n) = 2.5 %. A target has 192
// and determines its own to 5.1 %. The limits are four times that, and 2 % for separating the two parts. The common part
// is only 96 numbers and hardly shows in chi2.
TEST(PrintError, FollowsFromTheExcessOverNoise) {
  const Truth t = truth();
  for (const double error_mm : {0.002, 0.01}) {
    const PrintError error = estimate(t, views(t, error_mm, error_mm));
    EXPECT_NEAR(error.references_mm / error_mm, 1.0, 0.12) << "seed " << kPrintSeed;
    EXPECT_NEAR(error.targets_mm.back() / error_mm, 1.0, 0.22) << "seed " << kPrintSeed;
  }
}

// A target was printed on stretched paper, its references were not. If its error counted as theirs, lens and poses would
// follow the target.
TEST(PrintError, OfOneTargetIsNotThatOfTheReferences) {
  const Truth t = truth();
  constexpr double kError_mm = 0.02;
  auto frames = views(t, 0.0, 0.0);
  const auto rough = views(t, kError_mm, kError_mm);
  for (std::size_t k = 0; k < frames.size(); ++k) frames[k].points.back() = rough[k].points.back();
  const PrintError error = estimate(t, frames);
  EXPECT_EQ(error.references_mm, 0.0) << "seed " << kPrintSeed;
  EXPECT_NEAR(error.targets_mm.back() / kError_mm, 1.0, 0.22) << "seed " << kPrintSeed;
}

// A target is partly covered in one frame. Sixteen degrees of freedom, less its part of the pose, determine the error
// there to 18 %; the limit is three times that. Noise exceeds its quantile in one frame of a thousand.
TEST(PrintError, InOneFrameIsThatFramesOwn) {
  const Truth t = truth();
  constexpr double kError_mm = 0.02;
  auto frames = views(t, 0.0, 0.0);
  const std::size_t target = t.site.markers.size() - 1;
  frames[7].points[target] = views(t, kError_mm, kError_mm)[7].points[target];
  const auto fits = fits_of(t, frames);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const double error_mm = error_in_frame(t.site, t.scene, frames[k], fits[k], target);
    EXPECT_NEAR(error_mm / kError_mm, k == 7 ? 1.0 : 0.0, k == 7 ? 0.54 : 0.0)
        << "frame " << k << " seed " << kPrintSeed;
  }
}

// Gratings are printed to a few hundredths of a pitch at most. A grating read on the wrong lattice line has residuals
// of half a pitch or more. It is no print error: allowed for as one, its frames would look as if they fitted the scene.
TEST(PrintError, IsAtMostATwentiethOfAPitch) {
  const Truth t = truth();
  const auto frames = views(t, 0.5 * kPitch, 0.0);
  const PrintError error = estimate(t, frames);
  EXPECT_LE(error.references_mm, 0.05 * kPitch);
  EXPECT_LE(error.targets_mm.back(), 0.05 * kPitch);
  double chi2 = 0.0, dof = 0.0;
  for (const FrameFit& fit : fits_of(t, with_print_error(t.site, frames, error))) {
    chi2 += fit.chi2_sum;
    dof += static_cast<double>(fit.dof);
  }
  EXPECT_GT(chi2 / dof, 25.0) << "the limit of `untrusted`";
}

TEST(PrintError, BringsChi2ToItsDegreesOfFreedom) {
  const Truth t = truth();
  const auto frames = views(t, 0.01, 0.01);
  double chi2 = 0.0, dof = 0.0;
  for (const BundleFrame& frame : with_print_error(t.site, frames, everywhere(t, 0.01))) {
    const FrameFit fit = fit_frame(t.site, t.scene, frame);
    chi2 += fit.chi2_sum;
    dof += static_cast<double>(fit.dof);
  }
  EXPECT_NEAR(chi2 / dof, 1.0, 4.0 * std::sqrt(2.0 / dof)) << "seed " << kPrintSeed;
}

// The template's errors are as large as the noise and the same in every frame. So half the variance of the residuals
// scatters. There are 984 degrees of freedom, and 100 more that favour 1. The scatter of the result 0.74 is 0.5 sqrt(2
// / 984) / (2 * 0.74).
TEST(PrintError, ResidualsThatAreTheSameInAllFramesAreNotNoise) {
  const Truth t = truth();
  auto frames = views(t, 0.0, 0.0);
  for (BundleFrame& frame : frames) {
    for (auto& points : frame.points) points->information *= 0.5;
  }
  const auto fits = fits_of(t, frames);
  double dof = 0.0;
  for (const FrameFit& fit : fits) dof += static_cast<double>(fit.dof);
  const double share = noise_share(t.site, t.scene.model, fits, known(t));
  EXPECT_NEAR(share, std::sqrt((0.5 * dof + 100.0) / (dof + 100.0)), 4.0 * 0.35 * std::sqrt(2.0 / dof))
      << "seed " << kPrintSeed;
  double chi2 = 0.0;
  for (const FrameFit& fit : fits_of(t, with_print_error(t.site, frames, {.noise_share = share}))) chi2 += fit.chi2_sum;
  EXPECT_GT(chi2 / dof, 0.8) << "nearly all that chi2 was short of";
  EXPECT_LT(chi2 / dof, 1.0 + 4.0 * std::sqrt(2.0 / dof)) << "seed " << kPrintSeed;
}

TEST(MarkerJitter, IsZeroForFixedMarkers) {
  const Truth t = truth();
  EXPECT_EQ(wander(t, views(t, 0.0, 0.0)), 0.0) << "seed " << kPrintSeed;
}

// Four references have eight coordinates. A pose absorbs six of them, or fewer if the gratings' rotation and scale fix
// it. At least 200 numbers in 100 views determine a scatter to 5 %. The limit is four times that.
TEST(MarkerJitter, IsFoundAlthoughThePosesAbsorbMostOfIt) {
  const Truth t = truth();
  for (const double wander_um : {3.0, 30.0, 300.0})
    EXPECT_NEAR(1e3 * wander(t, views(t, 0.0, 1e-3 * wander_um, 100)) / wander_um, 1.0, 0.2) << "seed " << kPrintSeed;
}

TEST(MarkerJitter, StaysTheSameOnceTheWeightsIncludeIt) {
  const Truth t = truth();
  const auto frames = with_print_error(t.site, views(t, 0.0, 0.03, 100), {.marker_jitter_mm = 0.03});
  EXPECT_NEAR(wander(t, frames, 0.03) / 0.03, 1.0, 0.2) << "seed " << kPrintSeed;
}

// A grating of lines has no information along the lines. A print error does not change that.
TEST(PrintError, AnAxisThatIsNotShownStaysUnknown) {
  const Truth t = truth();
  auto frames = views(t, 0.0, 0.0);
  auto& information = frames.front().points.front()->information;
  information.bottomRightCorner<kPatchPoints, kPatchPoints>().setZero();
  const auto with = with_print_error(t.site, frames, everywhere(t, 0.01));
  const auto& kept = with.front().points.front()->information;
  EXPECT_LT((kept.bottomRows<kPatchPoints>().cwiseAbs().maxCoeff()), 1e-9);
  // One point of nine: its own 1 um and 10 um, and 10 um common to all.
  const Eigen::MatrixXd shown = kept.topLeftCorner<kPatchPoints, kPatchPoints>();
  EXPECT_NEAR(shown.inverse()(0, 0) * kPitch * kPitch, 1e-6 + 2e-4, 1e-8);
}

}  // namespace
}  // namespace moiregauge::internal
