// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/scene_change.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

constexpr double kU_mm = 0.002;

Samples one_target(double x, double y) {
  Sample sample;
  sample.displacement = {x, y};
  sample.u = {kU_mm, kU_mm};
  sample.status = Status::kOk;
  return {sample};
}

TEST(SceneChange, MovesTheCurveByAtMostHalfOfUPerFrame) {
  SceneChange change;
  change.begin(one_target(0.010, -0.004), one_target(0.0, 0.0));
  double x = 0.010, y = -0.004;
  for (int n = 0; n < 30; ++n) {
    Samples now = one_target(0.0, 0.0);
    change.apply(now);
    EXPECT_LE(std::abs(now.front().displacement.x - x), 0.5 * kU_mm + 1e-12) << n;
    EXPECT_LE(std::abs(now.front().displacement.y - y), 0.5 * kU_mm + 1e-12) << n;
    x = now.front().displacement.x;
    y = now.front().displacement.y;
  }
  EXPECT_EQ(x, 0.0);
  EXPECT_EQ(y, 0.0);
}

TEST(SceneChange, UContainsTheRemainingOffset) {
  SceneChange change;
  change.begin(one_target(0.010, 0.0), one_target(0.0, 0.0));
  Samples now = one_target(0.0, 0.0);
  change.apply(now);
  EXPECT_DOUBLE_EQ(now.front().u.x, std::hypot(kU_mm, now.front().displacement.x));
  EXPECT_EQ(now.front().u.y, kU_mm);
}

// Scenes that follow each other quickly, each off by its own u: no frame steps further than half of u.
TEST(SceneChange, ManyChangesInARowKeepTheLimit) {
  std::mt19937_64 rng(7);
  std::normal_distribution<double> error(0.0, kU_mm);
  SceneChange change;
  double scene = 0.0, last = 0.0;
  for (int n = 0; n < 2000; ++n) {
    if (n % 3 == 0) {
      const double next = error(rng);
      change.begin(one_target(scene, 0.0), one_target(next, 0.0));
      scene = next;
    }
    Samples now = one_target(scene, 0.0);
    change.apply(now);
    ASSERT_LE(std::abs(now.front().displacement.x - last), 0.5 * kU_mm + 1e-12) << n;
    last = now.front().displacement.x;
  }
}

TEST(SceneChange, ATargetWithoutValuesStartsWithoutAnOffset) {
  SceneChange change;
  change.begin(one_target(kNotMeasured, 0.010), one_target(0.0, 0.0));
  Samples now = one_target(0.0, kNotMeasured);
  change.apply(now);
  EXPECT_EQ(now.front().displacement.x, 0.0);
  EXPECT_TRUE(std::isnan(now.front().displacement.y));
  // The offset of the other axis waits for its next value.
  now = one_target(0.0, 0.0);
  change.apply(now);
  EXPECT_DOUBLE_EQ(now.front().displacement.y, 0.010 - 0.5 * kU_mm);
}

}  // namespace
}  // namespace moiregauge::internal
