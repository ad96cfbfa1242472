// SPDX-License-Identifier: Apache-2.0
// Tests the method without camera correction (paper Figs. 12-15 (b)): right with a fixed camera, wrong and reported so
// with a moving one.
#include <cmath>

#include <gtest/gtest.h>

#include "common/simulated_run.h"

namespace moiregauge::internal {
namespace {

test::MeasuredRun conventional(simulator::Scenario scenario, long step, long reference = 0) {
  test::RunPlan plan;
  plan.method = "conventional";
  plan.step = step;
  plan.reference_frame = reference;
  return test::measured(scenario, plan);
}

TEST(Conventional, AFixedCameraGivesTheTargetsMotion) {
  auto scenario = *simulator::built_in("small-0.1x");
  scenario.mount.rotation_x = {};
  const auto run = conventional(scenario, 4);
  ASSERT_TRUE(run.problem.empty()) << run.problem;
  for (const Sample& s : run.samples) EXPECT_EQ(s.status, Status::kOk) << "frame " << s.frame;
  // Noise alone: the largest of 40 is within 4 u.
  EXPECT_LE(test::largest(run.error_y_um), 4.0 * test::rms(run.u_y_um));
}

TEST(Conventional, RotationCausesAnErrorOfTheImageShiftAndIsReported) {
  // 0.1 deg shifts the image by f tan(0.1 deg) = 6.07 px, and the pivot adds its lever: 2.1 + 0.17 mm.
  const auto small = conventional(*simulator::built_in("rig-0.1x"), 8);
  ASSERT_TRUE(small.problem.empty()) << small.problem;
  EXPECT_NEAR(test::largest(small.error_y_um), 2270.0, 25.0);
  for (const char* name : {"rig-0.1x", "rig-1x", "rig-1xyz"}) {
    const auto run = conventional(*simulator::built_in(name), 8);
    for (const Sample& s : run.samples)
      EXPECT_TRUE(s.status == Status::kCameraMoved || s.status == Status::kLost) << name << " frame " << s.frame;
  }
}

TEST(Conventional, BeyondHalfAPitchThePhaseJumps) {
  const auto run = conventional(*simulator::built_in("rig-1x"), 8);
  ASSERT_TRUE(run.problem.empty()) << run.problem;
  for (const Sample& s : run.samples) {
    if (has_numbers(s.status)) {
      EXPECT_LE(std::abs(s.displacement.y), 5.0 + 1e-9);
    }
  }
  EXPECT_GT(test::largest(run.error_y_um), 5000.0);  // 23 mm of apparent motion, read within half a pitch of 10 mm
}

simulator::Scenario still_camera(std::vector<simulator::Knot> dy) {
  auto scenario = *simulator::built_in("small-still");
  scenario.markers.back().dy = simulator::Track{};
  scenario.markers.back().dy.knots = std::move(dy);
  // Large enough for the fixed window to remain on the grating.
  scenario.markers.back().print.grating->width_mm = scenario.markers.back().print.grating->height_mm = 70.0;
  return scenario;
}

// 12 mm up at 0.5 mm per frame: continuity gives the fringe order of every frame.
TEST(Conventional, TravelBeyondHalfAPitchIsFollowedFromFrameToFrame) {
  const auto scenario = still_camera({{0.0, 0.0}, {2.4, 12.0}, {4.0, 12.0}});
  for (const long reference : {0L, 30L}) {
    test::RunPlan plan{.method = "conventional", .frames = 32, .reference_frame = reference};
    const auto run = test::measured(scenario, plan);
    ASSERT_TRUE(run.problem.empty()) << run.problem;
    long ok = 0;
    std::size_t k = 0;
    for (const Sample& s : run.samples) {
      EXPECT_NE(s.status, Status::kOrderUnproven) << "frame " << s.frame;
      if (!has_numbers(s.status)) continue;
      // The error is that of the harmonics in a fixed window. A wrong order would be 10 000 um.
      EXPECT_LT(std::abs(run.error_y_um[k++]), 200.0) << "frame " << s.frame;
      ok += s.status == Status::kOk && std::abs(s.displacement.y) > 5.0;
    }
    EXPECT_GT(ok, 4) << "beyond half a pitch, reference frame " << reference;
  }
}

// A little more than half a pitch between two frames looks like a little less in the other direction.
TEST(Conventional, AfterAJumpOfHalfAPitchTheOrderIsUnproven) {
  for (const double leap_mm : {3.0, 5.6}) {
    const auto scenario = still_camera({{0.0, 0.0}, {0.45, 0.0}, {0.46, leap_mm}, {4.0, leap_mm}});
    test::RunPlan plan{.method = "conventional", .frames = 10};
    const auto run = test::measured(scenario, plan);
    for (const Sample& s : run.samples) {
      EXPECT_EQ(s.status, s.frame < 5 ? Status::kOk : Status::kOrderUnproven)
          << "frame " << s.frame << ", " << leap_mm << " mm";
    }
  }
}

}  // namespace
}  // namespace moiregauge::internal
