// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/rate_window.h"

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

constexpr std::int64_t kMs = 1'000'000;

TEST(RateWindow, GivesPercentilesAndRateOfTheLastFrames) {
  RateWindow window;
  LiveHealth health;
  window.describe(health);
  EXPECT_TRUE(std::isnan(health.latency_p50_ms));
  // Frames every 20 ms. Early ones are slow and leave the window; of the others, 2 in 100 take 30 ms.
  for (int n = 0; n < 5000; ++n) {
    const std::int64_t latency = n < 2000 ? 500 * kMs : n % 50 == 0 ? 30 * kMs : 4 * kMs;
    window.add(n * 20 * kMs, n * 20 * kMs + latency);
  }
  window.describe(health);
  EXPECT_DOUBLE_EQ(health.latency_p50_ms, 4.0);
  EXPECT_DOUBLE_EQ(health.latency_p99_ms, 30.0);
  EXPECT_DOUBLE_EQ(health.frames_per_s, 50.0);
}

}  // namespace
}  // namespace moiregauge::internal
