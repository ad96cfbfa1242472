// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/key_frames.h"

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

Observation seen_at(long frame, double fps) {
  Observation seen;
  seen.frame = frame;
  seen.time_s = static_cast<double>(frame) / fps;
  return seen;
}

TEST(KeyFrames, StayBoundedAndSpanTheWholeRun) {
  KeyFrames keys({.max_frames = 16});
  for (long n = 0; n < 100'000; ++n) {
    keys.add(seen_at(n, 42.0));
    ASSERT_LE(keys.frames().size(), 16U);
  }
  EXPECT_EQ(keys.frames().front().frame, 0);
  EXPECT_GT(keys.frames().size(), 8U);
  // At most one stride is missing at the end: a stride is at least an eighth of the run.
  EXPECT_GT(keys.frames().back().frame, 100'000 - 100'000 / 8);
}

TEST(KeyFrames, ForgetFramesBeyondTheirAge) {
  constexpr double kMaxAge_s = 60.0;
  KeyFrames keys({.max_frames = 16, .max_age_s = kMaxAge_s});
  double longest_s = 0.0;
  for (long n = 0; n < 100'000; ++n) {
    keys.add(seen_at(n, 42.0));
    ASSERT_LE(keys.frames().size(), 16U);
    longest_s = std::max(longest_s, keys.frames().back().time_s - keys.frames().front().time_s);
  }
  // The stride doubles last when 17 frames span just less than the age. Afterwards 16 of twice the stride remain.
  EXPECT_LT(longest_s, 2.0 * kMaxAge_s);
  EXPECT_GT(longest_s, 0.9 * kMaxAge_s);
  EXPECT_GT(keys.frames().front().time_s, 100'000 / 42.0 - 2.0 * kMaxAge_s);
}

TEST(KeyFrames, TakeAWantedFrameBetweenStrides) {
  KeyFrames keys({.max_frames = 4});
  for (long n = 0; n < 7; ++n) keys.add(seen_at(n, 1.0));  // the stride is 2 by now
  EXPECT_FALSE(keys.add(seen_at(7, 1.0)));
  keys.add(seen_at(8, 1.0));
  EXPECT_TRUE(keys.add(seen_at(9, 1.0), true));
  EXPECT_EQ(keys.frames().back().frame, 9);
}

}  // namespace
}  // namespace moiregauge::internal
