// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/frame_times.h"

#include <utility>

namespace moiregauge::internal {
namespace {

class TimedSource final : public FrameSource {
 public:
  TimedSource(std::unique_ptr<FrameSource> source, FrameTimes& times) : source_(std::move(source)), times_(times) {}
  [[nodiscard]] const InputInfo& info() const override { return source_->info(); }
  [[nodiscard]] bool is_frame_whole() const override { return source_->is_frame_whole(); }
  [[nodiscard]] tl::expected<std::optional<Frame>, InputError> next() override {
    const auto asked = Clock::now();
    auto frame = source_->next();
    const auto given = Clock::now();
    if (frames_ > 1) times_.add_measuring(asked - given_);
    if (frames_ > 0) times_.add_waiting(given - asked);
    ++frames_;
    given_ = given;
    return frame;
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::unique_ptr<FrameSource> source_;
  FrameTimes& times_;
  long frames_ = 0;
  Clock::time_point given_;
};

}  // namespace

std::unique_ptr<FrameSource> timed(std::unique_ptr<FrameSource> source, FrameTimes& times) {
  return std::make_unique<TimedSource>(std::move(source), times);
}

}  // namespace moiregauge::internal
