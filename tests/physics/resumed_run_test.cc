// SPDX-License-Identifier: Apache-2.0
// A run that is stopped and resumed keeps every frame that it has observed.
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>

#include <gtest/gtest.h>

#include "moiregauge/run/measure.h"
#include "moiregauge/simulator/recorder.h"

namespace moiregauge::internal {
namespace {

using simulator::Scenario;

// Frames of a scenario as the sensor stores them.
class RenderedSource final : public FrameSource {
 public:
  RenderedSource(const Scenario& scenario, long frames)
      : scenario_(scenario), frames_(frames), recorder_(scenario, {.area = simulator::Area::kMarkersOnly}) {
    info_.path = scenario.name;
    info_.frames = frames;
    info_.width = scenario.camera.width;
    info_.height = scenario.camera.height;
    info_.bits = scenario.sensor.bits;
    info_.fps = scenario.sensor.fps;
  }
  [[nodiscard]] const InputInfo& info() const override { return info_; }
  [[nodiscard]] tl::expected<std::optional<Frame>, InputError> next() override {
    if (next_ == frames_) return std::nullopt;
    picture_ = recorder_.frame(next_);
    const double time = simulator::time_of(scenario_, next_);
    return Frame{next_++, time, false, simulator::view_of(picture_)};
  }

 private:
  const Scenario& scenario_;
  long frames_;
  simulator::Recorder recorder_;
  InputInfo info_;
  long next_ = 0;
  simulator::Picture picture_;
};

// Stopped at its second frame while it passes over six kept ones, and at its ninth, after them.
TEST(ResumedRun, KeepsAllFramesWhereverItIsStopped) {
  const Scenario scenario = *simulator::built_in("small-1xyz");
  const auto open = [&]() -> tl::expected<std::unique_ptr<FrameSource>, InputError> {
    return std::make_unique<RenderedSource>(scenario, 12);
  };
  MeasureOptions options;
  options.method = method_named("precise");
  options.site = simulator::site_of(scenario);
  const auto until = [](long frames) { return [frames](long done, long) { return done < frames; }; };
  const auto first = observe_all(open, options, until(6));
  ASSERT_TRUE(first) << first.error().message;
  ASSERT_TRUE(first->reference);
  ASSERT_EQ(first->observations.size(), 6U);
  for (const auto& [stop, frames] : {std::pair<long, std::size_t>{2, 6}, {9, 9}}) {
    const auto again = observe_all(open, options, until(stop), {.so_far = *first});
    ASSERT_TRUE(again) << "stopped at frame " << stop << ": " << again.error().message;
    EXPECT_TRUE(again->interrupted);
    ASSERT_EQ(again->observations.size(), frames);
    for (std::size_t n = 0; n < frames; ++n) EXPECT_EQ(again->observations[n].frame, static_cast<long>(n));
  }
}

}  // namespace
}  // namespace moiregauge::internal
