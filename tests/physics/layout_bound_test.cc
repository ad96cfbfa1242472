// SPDX-License-Identifier: Apache-2.0
// Tests the bound that a run states from its images, against the closed form of the simulated scene.
#include "moiregauge/planning/layout_bound.h"

#include <cmath>

#include <gtest/gtest.h>

#include "common/simulated_run.h"
#include "moiregauge/simulator/scenario/built_in.h"
#include "moiregauge/units/units.h"
#include "studies/precise_bounds.h"

namespace moiregauge::internal::test {
namespace {

struct Bounds {
  Extent<frame::Board> stated, true_um;
};

Bounds bounds_of(Pattern pattern, Bound bound) {
  simulator::Scenario s = *simulator::built_in("small-1xyz");
  for (auto& marker : s.markers) marker.print.grating->pattern = pattern;
  RunPlan plan;
  plan.method = "precise";
  plan.frames = 1;
  const MeasuredRun run = measured(s, plan);
  EXPECT_EQ(run.problem, "");
  const auto mm = layout_bound(run.reference, s.markers.size() - 1, bound);
  return {{1000.0 * mm.x, 1000.0 * mm.y},
          bound == Bound::kPhase ? study::phase_bound_um(s, 0) : study::full_bound_um(s, 0)};
}

void expect_agreement(const Bounds& b, double within) {
  EXPECT_NEAR(b.stated.x / b.true_um.x, 1.0, within) << b.stated.x;
  EXPECT_NEAR(b.stated.y / b.true_um.y, 1.0, within) << b.stated.y;
}

// Noise and amplitudes are known to 1 % each from 7000 pixels and more, the view to 0.1 %.
TEST(LayoutBound, FundamentalBoundEqualsThatOfTheScene) {
  expect_agreement(bounds_of(Pattern::kGrid, Bound::kPhase), 0.03);
  expect_agreement(bounds_of(Pattern::kCosine, Bound::kPhase), 0.03);
}

// Returns the variance of a shift for crossed lines of contrast C, with edges blurred by sigma. An edge has the squared
// slopes C^2 / (2 sqrt(pi) sigma). A pitch P has two edges. The other lines leave 1/2 - 2 sigma / (sqrt(pi) P) of each
// edge visible.
double shift_variance_px2(const simulator::Scenario& s, double side_px, double pitch_px) {
  const double blur = std::sqrt(s.sensor.psf_sigma_px * s.sensor.psf_sigma_px + 1.0 / 12.0), root = std::sqrt(kPi);
  const double noise2 = s.sensor.noise_sigma * s.sensor.noise_sigma + 1.0 / 12.0;
  const double contrast = s.light.white - s.light.black;
  const double slopes = contrast * contrast / (root * blur * pitch_px) * (0.5 - 2.0 * blur / (root * pitch_px));
  return noise2 / (slopes * side_px * side_px);
}

TEST(LayoutBound, FullBoundFollowsTheClosedFormOfCrossedLines) {
  const simulator::Scenario s = *simulator::built_in("small-1xyz");
  const double mm_per_px = 1200.0 / 3478.26;  // small rig: references of 30 mm at (+-100, +-40), target of 40 mm
  const double own = shift_variance_px2(s, 40.0 / mm_per_px, 10.0 / mm_per_px);
  const double reference = shift_variance_px2(s, 30.0 / mm_per_px, 10.0 / mm_per_px);
  const auto u_um = [&](double ratio) {
    return 1000.0 * mm_per_px * std::sqrt(own + 0.25 * reference * (1.0 + ratio * ratio));
  };
  const Bounds b = bounds_of(Pattern::kGrid, Bound::kFull);
  expect_agreement({b.stated, {u_um(100.0 / 40.0), u_um(40.0 / 100.0)}}, 0.03);
  // The scene's value also counts the border of the grating and of its paper.
  EXPECT_GT(b.stated.x, b.true_um.x);
  EXPECT_GT(b.stated.y, b.true_um.y);
}

}  // namespace
}  // namespace moiregauge::internal::test
