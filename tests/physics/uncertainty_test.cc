// SPDX-License-Identifier: Apache-2.0
// Tests that the stated noise equals the scatter of repeated recordings, and that layouts follow their closed forms.
#include <array>
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "common/simulated_run.h"
#include "moiregauge/planning/reference_weights.h"

namespace moiregauge::internal {
namespace {

TEST(Layout, FlatLayoutsAreWorseSideways) {
  // u_x = (s/2) sqrt(1 + (a/b)^2), u_y = (s/2) sqrt(1 + (b/a)^2) for references at (+-a, +-b), target in the centre.
  for (const auto& [a, b] : {std::pair{380.0, 28.0}, {100.0, 100.0}, {60.0, 300.0}}) {
    const std::array<BoardPoint, 4> references{{{-a, b}, {a, b}, {-a, -b}, {a, -b}}};
    const auto weights = reference_weights(references, {0.0, 0.0});
    const std::vector<Extent<frame::Board>> u(4, {1.0, 1.0});
    const auto at_target = through_references(weights, u);
    EXPECT_NEAR(at_target.x, 0.5 * std::hypot(1.0, a / b), 1e-9 * a / b);
    EXPECT_NEAR(at_target.y, 0.5 * std::hypot(1.0, b / a), 1e-9 * b / a + 1e-9);
  }
}

TEST(Layout, ACommonShiftOfTheReferencesShiftsTheTargetByTheSame) {
  const std::array<BoardPoint, 5> references{{{-380, 28}, {380, 28}, {-380, -28}, {380, -28}, {10, 200}}};
  Matrix2 sum = Matrix2::Zero();
  for (const Matrix2& w : reference_weights(references, {12.0, -7.0})) sum += w;
  EXPECT_NEAR((sum - Matrix2::Identity()).norm(), 0.0, 1e-9);
}

TEST(Uncertainty, TheStatedNoiseIsTheScatterOfRepeatedRecordings) {
  // A fixed camera, 10 runs of 30 frames: scatter about each run's mean against the noise and references parts of u.
  std::vector<double> scatter_y, stated_y;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    auto scenario = *simulator::built_in("small-0.1x");
    scenario.seed = seed;
    scenario.mount.rotation_x = {};
    test::RunPlan plan;
    plan.frames = 31;
    const auto run = test::measured(scenario, plan);
    ASSERT_TRUE(run.problem.empty()) << run.problem;
    scatter_y.push_back(test::scatter(run.error_y_um));
    for (const Sample& s : run.samples)
      stated_y.push_back(1000.0 * std::hypot(s.budget.noise.y, s.budget.references.y));
  }
  // 290 degrees of freedom: the relative standard error is 1 / sqrt(580) = 4.2 %. Four of them are allowed.
  EXPECT_NEAR(test::rms(scatter_y) / test::rms(stated_y), 1.0, 0.17);
}

// Measures a target that moves through all fractions of a pixel. The pitch is 28.99 px, so all lines have the same
// fraction.
test::MeasuredRun measured_across_pixels(double psf_px, int median_px) {
  auto scenario = *simulator::built_in("small-still");
  scenario.sensor.psf_sigma_px = psf_px;
  scenario.processing.median_px = median_px;
  for (auto& marker : scenario.markers) {
    marker.ink.line_share = 0.35;
    if (marker.print.role != Role::kTarget) continue;
    marker.dy = {.knots = {{0.0, 0.0}, {2.0, 0.6}}};
    marker.dx = {.knots = {{0.0, 0.0}, {2.0, 0.44}}};
  }
  scenario.sensor.fps = 10.0;
  return test::measured(scenario, {.method = "precise", .frames = 20});
}

// Edges sharper than a pixel fold harmonics. A median filter sharpens the corners of a grating.
TEST(Uncertainty, CoversErrorsThatRepeatWithEveryPixel) {
  for (const auto& [psf_px, median_px] : {std::pair{0.4, 0}, {0.7, 5}}) {
    const auto run = measured_across_pixels(psf_px, median_px);
    ASSERT_TRUE(run.problem.empty()) << run.problem;
    EXPECT_GT(test::rms(run.error_y_um), 1.5) << "the noise is 0.4 um";
    for (std::size_t k = 0; k < run.error_y_um.size(); ++k) {
      EXPECT_LT(std::abs(run.error_x_um[k]), 3.0 * run.u_x_um[k]) << "PSF " << psf_px << " px, row " << k;
      EXPECT_LT(std::abs(run.error_y_um[k]), 3.0 * run.u_y_um[k]) << "PSF " << psf_px << " px, row " << k;
    }
    EXPECT_TRUE(test::notes(run, "repeats with every pixel")) << psf_px;
  }
}

// The noise alone gives 0.9 um.
TEST(Uncertainty, IsThatOfNoiseBehindAUsualBlur) {
  const auto run = measured_across_pixels(0.7, 0);
  ASSERT_TRUE(run.problem.empty()) << run.problem;
  EXPECT_LT(test::rms(run.u_y_um), 1.1);
  EXPECT_FALSE(test::notes(run, "repeats with every pixel"));
}

}  // namespace
}  // namespace moiregauge::internal
