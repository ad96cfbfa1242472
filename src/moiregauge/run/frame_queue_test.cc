// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/run/frame_queue.h"

#include <thread>

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

constexpr std::chrono::milliseconds kNow{0}, kLong{10'000};
constexpr int kWidth = 5, kHeight = 3;

// A frame whose pixels state its number.
LiveFrame frame_of(long number, Image<std::uint8_t>& pixels) {
  pixels = Image<std::uint8_t>(kWidth, kHeight, static_cast<std::uint8_t>(number));
  LiveFrame frame;
  frame.frame.number = number;
  frame.frame.luma = pixels.view();
  return frame;
}

int grey_of(const LiveFrame& frame) {
  return std::get<ImageView<std::uint8_t>>(frame.frame.luma).at(kWidth - 1, kHeight - 1);
}

TEST(FrameQueue, KeepsTheOldestFramesAndCountsTheOthers) {
  FrameQueue queue(3);
  Image<std::uint8_t> pixels;
  for (long n = 0; n < 10; ++n) (void)queue.put(frame_of(n, pixels));
  // Three wait, and one buffer more is for the frame that is measured.
  EXPECT_EQ(queue.lost(), 6);
  for (long n = 0; n < 4; ++n) {
    const auto frame = queue.take(kNow);
    ASSERT_TRUE(frame && *frame);
    EXPECT_EQ((*frame)->frame.number, n);
    EXPECT_EQ(grey_of(**frame), n);
    EXPECT_EQ((*frame)->queued, 3 - n);
  }
  const auto none = queue.take(kNow);
  ASSERT_TRUE(none);
  EXPECT_FALSE(*none);
}

TEST(FrameQueue, AFrameStaysValidUntilTheNextOneIsTaken) {
  FrameQueue queue(1);
  Image<std::uint8_t> pixels;
  ASSERT_TRUE(queue.put(frame_of(7, pixels)));
  const auto taken = queue.take(kNow);
  for (long n = 8; n < 20; ++n) (void)queue.put(frame_of(n, pixels));
  EXPECT_EQ(grey_of(**taken), 7);
  EXPECT_EQ(queue.lost(), 11);  // one buffer was free
}

TEST(FrameQueue, DeliversWaitingFramesBeforeTheEnd) {
  FrameQueue queue(2);
  Image<std::uint8_t> pixels;
  ASSERT_TRUE(queue.put(frame_of(0, pixels)));
  queue.end({SourceEnd::Kind::kLost, "unplugged"});
  ASSERT_TRUE(queue.take(kNow).value());
  for (int n = 0; n < 2; ++n) {
    const auto end = queue.take(kNow);
    ASSERT_FALSE(end);
    EXPECT_EQ(end.error().kind, SourceEnd::Kind::kLost);
    EXPECT_EQ(end.error().message, "unplugged");
  }
}

TEST(FrameQueue, LosesNothingWhenTheProducerWaits) {
  constexpr long kFrames = 500;
  FrameQueue queue(2);
  std::jthread producer([&](const std::stop_token& stop) {
    Image<std::uint8_t> pixels;
    for (long n = 0; n < kFrames; ++n) (void)queue.put_waiting(frame_of(n, pixels), stop);
    queue.end({});
  });
  long next = 0;
  for (auto frame = queue.take(kLong); frame && *frame; frame = queue.take(kLong)) {
    EXPECT_EQ((*frame)->frame.number, next);
    EXPECT_EQ(grey_of(**frame), next % 256);
    ++next;
  }
  EXPECT_EQ(next, kFrames);
  EXPECT_EQ(queue.lost(), 0);
}

TEST(FrameQueue, CopiesDeepFramesAndTheQuantisersOfTheirBlocks) {
  FrameQueue queue(1);
  Image<std::uint16_t> deep(kWidth, kHeight, 4000);
  Image<std::uint8_t> blocks(1, 1, 28);
  LiveFrame frame;
  frame.frame.luma = deep.view();
  frame.frame.quantiser.blocks = blocks.view();
  ASSERT_TRUE(queue.put(frame));
  deep.at(0, 0) = 1;
  blocks.at(0, 0) = 1;
  const auto taken = queue.take(kNow);
  EXPECT_EQ(std::get<ImageView<std::uint16_t>>((*taken)->frame.luma).at(0, 0), 4000);
  EXPECT_EQ((*taken)->frame.quantiser.blocks.at(0, 0), 28);
}

TEST(FrameQueue, AStopRequestEndsTheWaitForSpace) {
  FrameQueue queue(1);
  Image<std::uint8_t> pixels;
  while (queue.put(frame_of(0, pixels))) {
  }
  std::jthread producer(
      [&](const std::stop_token& stop) { EXPECT_FALSE(queue.put_waiting(frame_of(1, pixels), stop)); });
  producer.request_stop();
}

}  // namespace
}  // namespace moiregauge::internal
