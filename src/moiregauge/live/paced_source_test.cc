// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/paced_source.h"

#include <gtest/gtest.h>
#include <algorithm>

#include "moiregauge/live/clocks.h"
#include "moiregauge/live/recording_for_tests.h"

namespace moiregauge::internal {
namespace {

using test::TinyRecording;
constexpr std::chrono::milliseconds kTimeout{5000};

std::unique_ptr<TinyRecording> recording(long frames, std::string message = {}) {
  return std::make_unique<TinyRecording>(frames, std::move(message));
}

struct Delivered {
  std::vector<long> numbers;
  SourceEnd end;
};

Delivered all_of(LiveSource& source, std::chrono::milliseconds work) {
  Delivered out;
  for (auto frame = source.next(kTimeout);; frame = source.next(kTimeout)) {
    if (!frame) {
      out.end = frame.error();
      return out;
    }
    if (!*frame) continue;
    out.numbers.push_back((*frame)->frame.number);
    EXPECT_EQ(std::get<ImageView<std::uint8_t>>((*frame)->frame.luma).at(0, 0), (*frame)->frame.number % 256);
    std::this_thread::sleep_for(work);
  }
}

TEST(PacedSource, DeliversEveryFrameInTimeToAFastConsumer) {
  // 40 frames of 10 ms at twice the speed: 195 ms from the first to the last.
  PacedSource source(recording(40), 2.0);
  const std::int64_t begin = steady_ns();
  const Delivered out = all_of(source, {});
  EXPECT_GE(steady_ns() - begin, 190'000'000);
  EXPECT_EQ(out.end.kind, SourceEnd::Kind::kFinished);
  EXPECT_EQ(out.numbers.size() + static_cast<std::size_t>(source.lost().queue_full), 40U);
  EXPECT_EQ(source.info().frames, 40);
}

TEST(PacedSource, LosesFramesAsACameraWhenTheConsumerIsSlow) {
  // 200 frames in 0.1 s, each measured in 5 ms: about 20 pass the queue, and 5 more that wait at the end.
  PacedSource source(recording(200), 20.0, -1, 4);
  const Delivered out = all_of(source, std::chrono::milliseconds(5));
  EXPECT_GT(source.lost().queue_full, 100);
  EXPECT_EQ(out.numbers.size() + static_cast<std::size_t>(source.lost().queue_full), 200U);
  EXPECT_TRUE(std::ranges::is_sorted(out.numbers));
  EXPECT_EQ(out.numbers.front(), 0);
}

TEST(PacedSource, NeverLosesFramesThatAResumedRunHasMeasured) {
  PacedSource source(recording(60), 1000.0, 49, 2);
  const Delivered out = all_of(source, std::chrono::milliseconds(1));
  ASSERT_GE(out.numbers.size(), 50U);
  for (long n = 0; n < 50; ++n) EXPECT_EQ(out.numbers[static_cast<std::size_t>(n)], n);
}

TEST(PacedSource, EndsAtOnceWhenItIsNotRead) {
  PacedSource source(recording(100'000), 0.001);
  ASSERT_TRUE(source.next(kTimeout).value());
}

TEST(PacedSource, StatesWhyARecordingEndedEarly) {
  PacedSource paced(recording(3, "torn"), 1000.0);
  EXPECT_EQ(all_of(paced, {}).end.message, "torn");
  UnpacedSource unpaced(recording(3, "torn"));
  const Delivered out = all_of(unpaced, {});
  EXPECT_EQ(out.end.message, "torn");
  EXPECT_EQ(out.numbers, (std::vector<long>{0, 1, 2}));
}

}  // namespace
}  // namespace moiregauge::internal
