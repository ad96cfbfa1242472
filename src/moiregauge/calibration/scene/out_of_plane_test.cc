// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/scene/out_of_plane.h"

#include <cmath>

#include <gtest/gtest.h>

#include "moiregauge/calibration/scene/footage_for_tests.h"
#include "moiregauge/calibration/scene/frame_pose.h"

namespace moiregauge::internal {
namespace {

constexpr int kTrials = 40;

// A target 150 mm off the axis of a camera at 1200 mm. It is read in two frames, in the second one `raised_mm` nearer.
// `stretch`: points of that frame are farther apart along y, as a rolling shutter shows a target that moves along y.
struct Trial {
  OutOfPlane moved;
  Extent<frame::Board> appears;  // displacement that the fit with a fixed height gives
};
Trial trial(double raised_mm, double stretch, std::mt19937_64& rng) {
  test::Recording truth{.angles = test::swinging(0.5)};
  Marker& target = truth.site.markers.back();
  target.grating->centre = {150.0, 20.0};
  truth.height_mm.assign(truth.site.markers.size(), 0.0);
  Scene scene;
  scene.camera = truth.camera;
  scene.markers.resize(truth.site.markers.size());
  const std::vector<Extent<frame::Board>> still(truth.site.markers.size());
  BundleFrame then = test::frame_of(truth, 0.1, still, rng);
  truth.height_mm.back() = raised_mm;
  BundleFrame now = test::frame_of(truth, 0.6, still, rng);
  for (BundleFrame* frame : {&then, &now}) frame->pose = pose_of(truth.site, scene, *frame).value_or(frame->pose);
  for (PrintPoint& point : now.points.back()->print) point.y *= 1.0 - stretch;
  const FrameFit fit_then = fit_frame(truth.site, scene, then), fit_now = fit_frame(truth.site, scene, now);
  const auto shown_then = shown_heights(truth.site, scene, then, fit_then).back();
  const auto shown_now = shown_heights(truth.site, scene, now, fit_now).back();
  if (!shown_then || !shown_now) {
    ADD_FAILURE() << "no height";
    return {};
  }
  return {out_of_plane(*shown_now, *shown_then), fit_now.shift.back() - fit_then.shift.back()};
}

// Without a movement the height scatters by u. A movement is shown within a fifth. The pose takes a part of it:
// along y, the references of this rig are as near to each other as the target is large.
TEST(OutOfPlane, TheSizeOfTheGratingShowsTheMovement) {
  std::mt19937_64 rng(test::kFootageSeed);
  double chi2 = 0.0;
  for (int k = 0; k < kTrials; ++k) {
    const OutOfPlane still = trial(0.0, 0.0, rng).moved;
    chi2 += std::pow(still.height_mm / still.u_mm, 2);
    const Trial raised = trial(-8.0, 0.0, rng);
    EXPECT_NEAR(raised.moved.height_mm, -8.0, 1.6) << "seed " << test::kFootageSeed;
    // The fit with a fixed height shows the parallax: 150 mm of 1200 mm per mm.
    EXPECT_NEAR(raised.appears.x, -8.0 * 150.0 / 1200.0, 0.2) << "seed " << test::kFootageSeed;
    EXPECT_NEAR(raised.moved.apparent.x, raised.appears.x, 0.2) << "seed " << test::kFootageSeed;
  }
  // 40 squares of a normal variable: 40 +- 9. The pose adds to it.
  EXPECT_LT(chi2 / kTrials, 1.7) << "seed " << test::kFootageSeed;
}

// A rolling shutter stretches a target that moves along its rows' order. That is no height.
TEST(OutOfPlane, AStretchAlongOneAxisIsNoMovement) {
  std::mt19937_64 rng(test::kFootageSeed);
  for (int k = 0; k < kTrials; ++k) {
    const Trial stretched = trial(0.0, 0.003, rng), raised = trial(4.0, 0.0, rng);
    EXPECT_GT(std::abs(stretched.moved.height_mm), 5.0 * stretched.moved.u_mm);
    EXPECT_LT(stretched.moved.in_u, 4.0) << "seed " << test::kFootageSeed;
    EXPECT_GT(raised.moved.in_u, 10.0);
  }
}

constexpr long kSeriesFrames = 24;

// Heights of a target at 1 m, with noise of 0.1 mm along each axis. The stated u is 2.5 times that, as behind a codec.
template <typename Moved>
HeightSeries heights_of(std::mt19937_64& rng, const Moved& moved) {
  std::normal_distribution<double> noise(0.0, 0.1);
  HeightSeries series;
  for (long k = 0; k < kSeriesFrames; ++k) {
    const double by_x = moved(k) + noise(rng), by_y = moved(k) + noise(rng);
    ShownHeight shown;
    shown.height_mm = 0.5 * (by_x + by_y), shown.u_height_mm = 0.25 / std::sqrt(2.0);
    shown.stretch = (by_x - by_y) / 1000.0, shown.u_stretch = 2.0 * shown.u_height_mm / 1000.0;
    shown.camera.shift = {0.0, 0.0, 1000.0};
    series.add(shown);
  }
  return series;
}

// A step of 0.4 mm is within the stated scatter: its mean square is (0.2 / 0.35)^2 + (0.1 / 0.35)^2 = 0.4. Between frames
// the heights change by noise alone, so the variance is 5 times that of the steps.
TEST(HeightSeries, ASlowMovementIsProvenByWhatChangesFromFrameToFrame) {
  std::mt19937_64 rng(test::kFootageSeed);
  int step = 0, noise = 0, alternating = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const HeightSeries moved = heights_of(rng, [](long k) { return k < kSeriesFrames / 2 ? 0.0 : 0.4; });
    EXPECT_FALSE(moved.scatters());
    step += moved.drifts();
    noise += heights_of(rng, [](long) { return 0.0; }).drifts();
    alternating += heights_of(rng, [](long k) { return k % 2 == 0 ? 0.0 : 0.4; }).drifts();
  }
  // 1 / 5 is 1.2 standard deviations below 1 / 2.3. Both axes together are below it in four trials of five.
  EXPECT_GT(step, 800) << "seed " << test::kFootageSeed;
  // Noise exceeds three standard deviations once in 700, both axes once in 500 000.
  EXPECT_EQ(noise, 0) << "seed " << test::kFootageSeed;
  EXPECT_EQ(alternating, 0) << "seed " << test::kFootageSeed;
}

// A change of 0.03 mm at 1 m is that by the view alone: 2e-5 of the distance is 0.02 mm.
TEST(HeightSeries, AChangeBySizeOfTheSameViewIsNoMovement) {
  HeightSeries series;
  for (long k = 0; k < kSeriesFrames; ++k) {
    ShownHeight shown;
    shown.height_mm = k < kSeriesFrames / 2 ? 0.0 : 0.03;
    shown.u_height_mm = 0.01, shown.u_stretch = 1e-5;
    shown.camera.shift = {0.0, 0.0, 1000.0};
    series.add(shown);
  }
  EXPECT_FALSE(series.drifts());
}

}  // namespace
}  // namespace moiregauge::internal
