// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/precise/precise_scene.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "moiregauge/calibration/scene/footage_for_tests.h"
#include "moiregauge/observation/print/overshoot.h"
#include "moiregauge/phase/fit/template_for_tests.h"

namespace moiregauge::internal {
namespace {

using test::footage_of, test::lens, test::Recording, test::swinging;

constexpr std::size_t kTargetMarker = 4;

// Returns the step of an edge that the camera sharpened by `amount`.
double sharpened(double x, double amount) {
  constexpr double kBlur = 0.04;  // pitches
  const auto step = [](double at, double sigma) { return 0.5 * std::erfc(-at / (std::sqrt(2.0) * sigma)); };
  return (1.0 + amount) * step(x, kBlur) - amount * step(x, 1.6 * kBlur);
}

PrintModel light_squares(double amount) {
  const auto profile = [amount](double x) { return sharpened(std::abs(std::remainder(x, 1.0)) - 0.25, amount); };
  PrintModel model;
  model.print = testing::template_of(9, [&](double x, double y) { return 170.0 * profile(x) * profile(y); });
  return model;
}

// Returns u of the error at a grating's edge that the target's depth includes, px. A stated rest excludes it, because
// parallax then shows the depth.
double u_edge_px(const PrintModel& print) {
  const Recording truth{.camera = lens(-0.0225), .angles = swinging(4.0)};
  const FrameSeries frames = test::series_of(footage_of(truth, 8).frames);
  Reference reference;
  reference.site = truth.site;
  reference.view.ideal_from_board = test::seen_from(truth.camera, {});
  reference.prints.assign(truth.site.markers.size(), print);
  const ScenePrior prior = scene_prior(truth.site, truth.camera.width, truth.camera.height, std::nullopt);
  const auto variance = [&](const SolveOptions& options) {
    const PreciseScene solved = precise_scene(reference, frames, prior, options, false);
    EXPECT_EQ(solved.problem, "");
    const int row = shape_row(kTargetMarker, MarkerShape::kHeight);
    return solved.calibration.bundle.scene.full_covariance(row, row);
  };
  SolveOptions global_shutter;
  global_shutter.readout_s = 0.0;
  SolveOptions rest = global_shutter;
  rest.rest.emplace();
  const double u_mm = std::sqrt(variance(global_shutter) - variance(rest));
  const Grating& grating = *truth.site.markers[kTargetMarker].grating;
  const double half_px = 0.5 * grating.width_mm / reference.view.mm_per_px(grating.centre);
  return u_mm / 1200.0 * half_px;
}

// tools/light-study measures the error at an edge per e-fold of distance. It is up to 0.005 px without sharpening, and
// up to 0.011 px with an overshoot of 0.15, in proportion to it. The expanded uncertainty (k = 2) covers that, and is
// no more than four times as large.
TEST(PreciseScene, TheDepthIncludesTheErrorAtTheEdgesOfItsGrating) {
  const double unsharpened = u_edge_px(light_squares(0.0));
  EXPECT_GE(2.0 * unsharpened, 0.0049);
  EXPECT_LE(2.0 * unsharpened, 4.0 * 0.005);
  const PrintModel print = light_squares(1.0);
  const double overshoot = overshoot_of(print);
  EXPECT_NEAR(overshoot, 0.1, 0.05);
  const double expected = 0.011 * overshoot / 0.15;
  const double sharpened = u_edge_px(print);
  EXPECT_GE(2.0 * sharpened, expected);
  EXPECT_LE(2.0 * sharpened, 4.0 * expected);
}

// Footage in which the target comes nearer by 20 mm.
FrameSeries approaching(Recording truth) {
  constexpr int kApproachFrames = 24;
  std::mt19937_64 rng(test::kFootageSeed);
  std::vector<BundleFrame> frames;
  truth.height_mm.assign(truth.site.markers.size(), 0.0);
  for (int i = 0; i < kApproachFrames; ++i) {
    const double s = i / (kApproachFrames - 1.0);
    truth.height_mm.back() = 20.0 * s;
    frames.push_back(frame_of(truth, s, std::vector<Extent<frame::Board>>(truth.site.markers.size()), rng));
    frames.back().frame = i;
  }
  return test::series_of(frames);
}

bool removes_height(const Recording& truth) {
  Reference reference;
  reference.site = truth.site;
  reference.view.ideal_from_board = test::seen_from(truth.camera, truth.angles(0.0));
  reference.prints.resize(truth.site.markers.size());
  const ScenePrior prior = scene_prior(truth.site, truth.camera.width, truth.camera.height, std::nullopt);
  SolveOptions global_shutter;
  global_shutter.readout_s = 0.0;
  const PreciseScene solved = precise_scene(reference, approaching(truth), prior, global_shutter, false);
  EXPECT_EQ(solved.problem, "");
  return solved.movements && solved.movements->movement(truth.site.markers.size() - 1).leaves_plane();
}

// A height appears as a displacement in proportion to the distance from the camera's foot on the board. That distance
// follows from the focal length, which a camera that does not move does not show.
TEST(PreciseScene, AHeightIsRemovedOnlyWithAKnownFocalLength) {
  Recording truth{.site = test::rig_of_six(), .camera = lens(-0.0225), .angles = swinging(4.0)};
  EXPECT_TRUE(removes_height(truth)) << "seed " << test::kFootageSeed;
  truth.angles = [](double) { return test::Angles{2.0, -1.0, 0.5}; };
  EXPECT_FALSE(removes_height(truth)) << "seed " << test::kFootageSeed;
}

}  // namespace
}  // namespace moiregauge::internal
