// SPDX-License-Identifier: Apache-2.0
// Tests that the outline gives the fringe order of a target in every frame, for slow and fast movement.
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include <gtest/gtest.h>

#include "common/simulated_run.h"

namespace moiregauge::internal {
namespace {

simulator::Track sway(double amplitude_mm, double frequency_hz, double phase_deg) {
  simulator::Track track;
  track.amplitude = amplitude_mm;
  track.frequency_hz = frequency_hz;
  track.phase_deg = phase_deg;
  return track;
}

test::MeasuredRun precisely_by_steps(const simulator::Scenario& scenario, long step = 1, long frames = 40) {
  test::RunPlan plan;
  plan.method = "precise";
  plan.step = step;
  plan.frames = frames;
  return test::measured(scenario, plan);
}

void expect_every_order_right(const test::MeasuredRun& run, const char* what) {
  ASSERT_TRUE(run.problem.empty()) << run.problem;
  for (const Sample& s : run.samples)
    EXPECT_EQ(s.status, Status::kOk) << what << " frame " << s.frame << ' ' << word_for(s.status);
  ASSERT_EQ(run.error_y_um.size(), run.samples.size()) << what;
  for (std::size_t k = 0; k < run.samples.size(); ++k) {
    // A wrong order is an error of 10 mm. Noise and lens cause much less.
    EXPECT_LT(std::abs(run.error_x_um[k]), 50.0) << what << " frame " << run.samples[k].frame;
    EXPECT_LT(std::abs(run.error_y_um[k]), 50.0) << what << " frame " << run.samples[k].frame;
  }
  std::printf("%s: rms %.2f %.2f, u %.2f %.2f um\n", what, test::rms(run.error_x_um), test::rms(run.error_y_um),
              test::rms(run.u_x_um), test::rms(run.u_y_um));
}

simulator::SceneMarker& target_of(simulator::Scenario& scenario) {
  for (auto& m : scenario.markers) {
    if (m.print.role == Role::kTarget) return m;
  }
  std::abort();
}

TEST(FringeOrder, IsRightForATargetThatMovesSixTenthsOfAPitchPerFrame) {
  for (const Pattern pattern : {Pattern::kGrid, Pattern::kDots, Pattern::kCheckerboard, Pattern::kCosine}) {
    auto scenario = *simulator::built_in("small-1xyz");
    for (auto& m : scenario.markers) m.print.grating->pattern = pattern;
    scenario.camera.k1 = -0.37;
    // 30 mm x 2 pi x 0.33 Hz / 10 fps = 6.3 mm at most per frame.
    target_of(scenario).dy = sway(30.0, 0.33, 0.0);
    target_of(scenario).dx = sway(12.0, 0.5, 0.0);
    expect_every_order_right(precisely_by_steps(scenario), word_for(pattern));
  }
}

TEST(FringeOrder, IsRightForATargetThatJumpsSeveralPitchesBetweenFrames) {
  auto scenario = *simulator::built_in("small-1xyz");
  // Every 7th frame at 10 fps of a sine of 0.33 Hz: up to 40 mm apart.
  target_of(scenario).dy = sway(30.0, 0.33, 0.0);
  target_of(scenario).dx = sway(15.0, 0.47, 0.0);
  expect_every_order_right(precisely_by_steps(scenario, 7, 23), "jumps");
}

}  // namespace
}  // namespace moiregauge::internal
