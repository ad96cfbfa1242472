// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/frame_range_text.h"

#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

struct Seen {
  long frame = 0;
  double time_s = 0.0;
};

// Times of a camera with 30 frames/s, as a stream with millisecond stamps states them.
std::vector<Seen> stamped(long frames) {
  std::vector<Seen> out;
  for (long n = 0; n < frames; ++n) out.push_back({n, static_cast<double>(n * 1000 / 30) / 1000.0});
  return out;
}

std::vector<long> chosen(const FrameRange& range, const std::vector<Seen>& frames) {
  FrameSelector selector(range);
  std::vector<long> out;
  for (const Seen& seen : frames) {
    if (selector.holds(seen.frame, seen.time_s)) out.push_back(seen.frame);
  }
  return out;
}

FrameRange range_of(const char* text) { return frame_range_in(text, kFramesOption).value(); }

TEST(FrameRangeText, SecondsHaveAUnitAtBothEnds) {
  EXPECT_EQ(range_of("1.5s:3s").seconds->first_s, 1.5);
  EXPECT_EQ(range_of("1.5s:3s").seconds->end_s, 3.0);
  EXPECT_EQ(range_of("500ms:").seconds->first_s, 0.5);
  EXPECT_TRUE(std::isinf(range_of("500ms:").seconds->end_s));
  EXPECT_EQ(range_of(":2s").seconds->first_s, 0.0);
  EXPECT_EQ(range_of("0:2s").seconds->end_s, 2.0);
  EXPECT_EQ(range_of("0s:2s:3").step, 3);
  EXPECT_FALSE(range_of("10:20").seconds);
  EXPECT_EQ(range_of("10:20").first, 10);
  for (const char* text : {"1:3s", "1.5s:3", "1.5:3", "3s:1s", "1s:1s", "-1s:2s", "s:2s", "1s", "1s:2s:0", "1s:2s:1s",
                           "1parsec:2s", "", ":::", "20:10", "5:5", "nan s:2s"})
    EXPECT_FALSE(frame_range_in(text, kFramesOption)) << text;
  EXPECT_FALSE(frame_range_in("0:10:2", kRestOption));
}

TEST(FrameRangeText, TheMessageNamesTheOption) {
  const auto wrong = frame_range_in("5", kRestOption);
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.error().message.find("--rest 5: write frames A:B, half open, e.g. 0:20"), std::string::npos);
}

TEST(FrameRange, SecondsAreHalfOpen) {
  // Frames 30 to 59 are in the second of three seconds, whatever the rounding of their times.
  const auto frames = stamped(90);
  const std::vector<long> second = chosen(range_of("1s:2s"), frames);
  ASSERT_EQ(second.size(), 30U);
  EXPECT_EQ(second.front(), 30);
  EXPECT_EQ(second.back(), 59);
  EXPECT_EQ(chosen(range_of("1s:2s:10"), frames), (std::vector<long>{30, 40, 50}));
  EXPECT_EQ(chosen(range_of("30:60:10"), frames), (std::vector<long>{30, 40, 50}));
  EXPECT_TRUE(chosen(range_of("5s:"), frames).empty());
}

TEST(FrameRange, ATimeOnAnEndBelongsToTheLaterRange) {
  // 240 frames/s stored as 30: the division by 8 leaves rounding in the last bit.
  std::vector<Seen> frames;
  for (long n = 0; n < 2400; ++n) frames.push_back({n, static_cast<double>(n) / 30.0 / 8.0});
  for (long tenth = 1; tenth < 90; ++tenth) {
    FrameRange range;
    range.seconds = TimeRange{static_cast<double>(tenth) / 10.0};
    EXPECT_EQ(chosen(range, frames).front(), 24 * tenth);
    range.seconds = TimeRange{0.0, static_cast<double>(tenth) / 10.0};
    EXPECT_EQ(chosen(range, frames).back(), 24 * tenth - 1);
  }
}

TEST(FrameRange, AFrameThatLostItsTimeStaysWithItsNeighbours) {
  auto frames = stamped(90);
  frames[10].time_s = frames[40].time_s = frames[70].time_s = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(chosen(range_of("1s:2s"), frames).size(), 30U);
}

TEST(FrameRange, IsConvertedToTheFramesThatItHolds) {
  const auto frames = stamped(90);
  const auto second = in_frames(range_of("1s:2s"), frames);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->first, 30);
  EXPECT_EQ(second->end, 60);
  EXPECT_EQ(in_frames(range_of("1s:"), frames)->end, -1);
  EXPECT_FALSE(in_frames(range_of("5s:6s"), frames));
  EXPECT_FALSE(in_frames(range_of("90:100"), frames));
  EXPECT_EQ(in_frames(range_of("80:100"), frames)->end, 100);
}

}  // namespace
}  // namespace moiregauge::internal
