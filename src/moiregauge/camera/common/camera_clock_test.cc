// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/camera/common/camera_clock.h"

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

constexpr std::int64_t kMs = 1'000'000;

TEST(CameraClock, TimesAreThoseOfTheCameraHoweverLateTheHostReceivesThem) {
  CameraClock clock;
  EXPECT_EQ(clock.time_s(5000 * kMs, 100 * kMs), 0.0);
  EXPECT_DOUBLE_EQ(clock.time_s(5020 * kMs, 190 * kMs), 0.020);
  EXPECT_DOUBLE_EQ(clock.time_s(5040 * kMs, 191 * kMs), 0.040);
}

TEST(CameraClock, WithoutACameraClockTimesAreThoseOfTheHost) {
  CameraClock clock;
  EXPECT_EQ(clock.time_s(std::nullopt, 100 * kMs), 0.0);
  EXPECT_DOUBLE_EQ(clock.time_s(std::nullopt, 125 * kMs), 0.025);
  EXPECT_DOUBLE_EQ(clock.time_s(0, 150 * kMs), 0.050) << "a time stamp of 0 is none";
}

// The camera restarts its clock at 0 after 3.4 s without power. Only the host knows how long that took.
TEST(CameraClock, TheHostBridgesARestartOfTheCamera) {
  CameraClock clock;
  EXPECT_EQ(clock.time_s(90'000 * kMs, 100 * kMs), 0.0);
  EXPECT_DOUBLE_EQ(clock.time_s(1 * kMs, 3500 * kMs), 3.4);
  EXPECT_DOUBLE_EQ(clock.time_s(21 * kMs, 3520 * kMs), 3.42);
}

TEST(CameraClock, TimeNeverRunsBackwards) {
  CameraClock clock;
  double last = -1.0;
  for (const std::int64_t device : {100, 100, 90, 0, 2'000'000, 5, 6}) {
    const double now = clock.time_s(device, 1000);
    EXPECT_GT(now, last) << device;
    last = now;
  }
}

TEST(FrameCounter, AWrapOfTheIdentifierIsNoLoss) {
  FrameCounter counter;
  EXPECT_EQ(counter.number_of(65534), 0);
  EXPECT_EQ(counter.number_of(65535), 1);
  EXPECT_EQ(counter.number_of(1), 2) << "0 is skipped";
  EXPECT_EQ(counter.missing(), 0);
}

TEST(FrameCounter, MissingIdentifiersUseUpNumbers) {
  FrameCounter counter;
  EXPECT_EQ(counter.number_of(7), 0);
  EXPECT_EQ(counter.number_of(10), 3);
  EXPECT_EQ(counter.missing(), 2);
  counter.restart();
  EXPECT_EQ(counter.number_of(1), 4) << "a new connection counts from 1";
  EXPECT_EQ(counter.missing(), 2);
}

TEST(FrameCounter, IdentifiersOfSixtyFourBitsDoNotWrap) {
  FrameCounter counter;
  EXPECT_EQ(counter.number_of(65535), 0);
  EXPECT_EQ(counter.number_of(65536), 1);
  EXPECT_EQ(counter.number_of(65538), 3);
}

}  // namespace
}  // namespace moiregauge::internal
