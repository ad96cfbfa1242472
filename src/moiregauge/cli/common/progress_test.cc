// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/common/progress.h"

#include <thread>

#include <gtest/gtest.h>

#include "moiregauge/app/frame_times.h"

namespace moiregauge::internal::cli {
namespace {

TEST(Progress, TheLineSaysWhatLimitsTheRun) {
  EXPECT_EQ(progress_line("measuring", {240, 960, 10.0, 0.9}),
            "measuring [######..................] 240/960 frames, decode-bound, 24 fps, 30 s left");
  EXPECT_EQ(progress_line("measuring", {24, 96, 10.0, 0.1}),
            "measuring [######..................] 24/96 frames, measuring-bound, 2.4 fps, 30 s left");
}

TEST(Progress, ALengthThatIsNotKnownHasNoBar) {
  EXPECT_EQ(progress_line("measuring", {240, -1, 10.0, 0.9}), "measuring 240 frames, decode-bound, 24 fps");
}

TEST(Progress, WorkThatReadsNoFramesNamesNoLimit) {
  EXPECT_EQ(progress_line("simulating", {50, 100, 10.0, {}}),
            "simulating [############............] 50/100 frames, 5.0 fps, 10 s left");
}

TEST(Progress, MoreFramesThanTheFilePromisedFillTheBarAndNoMore) {
  EXPECT_EQ(progress_line("measuring", {12, 10, 1.0, 1.0}),
            "measuring [########################] 12/10 frames, decode-bound, 12 fps, 0 s left");
}

// Ten frames with a delay each.
class SlowSource final : public FrameSource {
 public:
  explicit SlowSource(std::chrono::milliseconds each) : each_(each) {}
  [[nodiscard]] const InputInfo& info() const override { return info_; }
  [[nodiscard]] tl::expected<std::optional<Frame>, InputError> next() override {
    std::this_thread::sleep_for(each_);
    if (number_ == 10) return std::optional<Frame>();
    return Frame{number_++, 0.0, false, {}};
  }

 private:
  InputInfo info_;
  std::chrono::milliseconds each_;
  long number_ = 0;
};

double waiting_share(std::chrono::milliseconds reading, std::chrono::milliseconds measuring) {
  FrameTimes times;
  const auto source = timed(std::make_unique<SlowSource>(reading), times);
  EXPECT_FALSE(times.waiting_share().has_value());
  while (source->next().value()) std::this_thread::sleep_for(measuring);
  return times.waiting_share().value();
}

TEST(FrameTimes, WhatTakesLongerHoldsTheGreaterShare) {
  using std::chrono::milliseconds;
  EXPECT_GT(waiting_share(milliseconds(20), milliseconds(1)), 0.5);
  EXPECT_LT(waiting_share(milliseconds(1), milliseconds(20)), 0.5);
}

}  // namespace
}  // namespace moiregauge::internal::cli
