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

}  // namespace
}  // namespace moiregauge::internal
