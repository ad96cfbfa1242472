// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/live_tracker.h"

#include <chrono>
#include <cmath>
#include <string_view>
#include <thread>

#include <gtest/gtest.h>

#include "moiregauge/live/clocks.h"
#include "moiregauge/live/live_loop.h"
#include "moiregauge/run/observing_run.h"
#include "moiregauge/simulator/simulator.h"

namespace moiregauge::internal {
namespace {

namespace sim = simulator;

sim::Scenario small_rig() { return *sim::built_in("small-1xyz"); }

// Returns the means of 3 x 3 pixels, as the software of a camera may smooth an image.
Image<std::uint8_t> smoothed(const Image<std::uint8_t>& sharp) {
  Image<std::uint8_t> out = sharp;
  for (int y = 1; y + 1 < sharp.height(); ++y) {
    for (int x = 1; x + 1 < sharp.width(); ++x) {
      int sum = 0;
      for (int k = 0; k < 9; ++k) sum += sharp.at(x + k % 3 - 1, y + k / 3 - 1);
      out.at(x, y) = static_cast<std::uint8_t>((sum + 4) / 9);
    }
  }
  return out;
}

// Renders each frame on demand. The end is a lost camera.
class RenderedCamera final : public LiveSource {
 public:
  RenderedCamera(const sim::Scenario& scenario, long frames, bool is_smooth = false)
      : scenario_(scenario), frames_(frames), is_smooth_(is_smooth) {
    info_.path = "camera";
    info_.width = scenario.camera.width;
    info_.height = scenario.camera.height;
    info_.fps = kFps;
  }
  [[nodiscard]] const InputInfo& info() const override { return info_; }
  [[nodiscard]] tl::expected<std::optional<LiveFrame>, SourceEnd> next(std::chrono::milliseconds /*timeout*/) override {
    if (next_ == frames_) return tl::unexpected(SourceEnd{SourceEnd::Kind::kLost, "unplugged"});
    picture_ = sim::render8(scenario_, next_, {.area = sim::Area::kMarkersOnly});
    if (is_smooth_) picture_ = smoothed(picture_);
    LiveFrame live;
    live.frame.number = next_;
    live.frame.time_s = static_cast<double>(next_++) / kFps;
    live.frame.luma = picture_.view();
    live.host_ns = steady_ns();
    return live;
  }
  [[nodiscard]] LostFrames lost() const override { return {}; }
  static constexpr double kFps = 10.0;

 private:
  const sim::Scenario& scenario_;
  long frames_;
  bool is_smooth_;
  long next_ = 0;
  InputInfo info_;
  Image<std::uint8_t> picture_;
};

// Keeps everything that is published. Waits after each frame, so that scenes are solved meanwhile.
class KeepingPublisher final : public Publisher {
 public:
  void start(const LiveRun& run) override { run_ = run; }
  void put(const PublishedFrame& frame) override {
    frames_.push_back(frame);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  void finish(double /*seconds*/) override {}
  LiveRun run_;
  std::vector<PublishedFrame> frames_;
};

struct LiveResult {
  LiveEnd end;
  KeepingPublisher published;
  std::size_t key_frames = 0;
};

LiveResult follow(const sim::Scenario& scenario, RenderedCamera camera, KeyFrameLimits limits,
                  std::string_view method = "precise") {
  MeasureOptions options;
  options.method = method_named(method);
  options.site = sim::site_of(scenario);
  LiveTracker tracker(options, camera.info(), {}, limits);
  LiveResult out;
  LiveLoopHooks hooks;
  hooks.publishers = {&out.published};
  out.end = run_live_loop(camera, tracker, hooks);
  out.key_frames = tracker.key_frames();
  EXPECT_TRUE(tracker.log().observations.empty());  // the journal has them
  return out;
}

TEST(LiveTracker, PublishesTheTruthWithinItsUncertainty) {
  const sim::Scenario scenario = small_rig();
  const LiveResult out = follow(scenario, {scenario, 60}, {});
  EXPECT_EQ(out.end.why, LiveStop::kLost);
  EXPECT_EQ(out.end.message, "unplugged");
  ASSERT_EQ(out.published.frames_.size(), 60U);
  ASSERT_EQ(out.published.run_.targets.size(), 1U);
  const std::string& name = out.published.run_.markers[out.published.run_.targets.front()];
  const sim::SceneMarker& marker = *sim::find_marker(scenario, name);
  int trusted = 0;
  for (const PublishedFrame& frame : out.published.frames_) {
    ASSERT_EQ(frame.rows.size(), 1U);
    const Sample& row = frame.rows.front();
    if (row.status != Status::kOk || frame.frame == 0) continue;
    ++trusted;
    const sim::Truth truth = sim::truth(scenario, frame.frame, marker);
    EXPECT_LT(std::abs(row.displacement.x - truth.dx_mm), 5.0 * row.u.x) << frame.frame;
    EXPECT_LT(std::abs(row.displacement.y - truth.dy_mm), 5.0 * row.u.y) << frame.frame;
  }
  // The scene of the first two frames is ready after some frames, however slow the machine is.
  EXPECT_GT(trusted, 20);
  EXPECT_GE(out.published.frames_.back().health.scenes, 2);
}

TEST(LiveTracker, KeyFramesStayBounded) {
  const sim::Scenario scenario = small_rig();
  const LiveResult out = follow(scenario, {scenario, 40}, {.max_frames = 8, .max_age_s = 2.0});
  EXPECT_LE(out.key_frames, 8U);
  EXPECT_GE(out.key_frames, 4U);
}

// The coarse noise that moves a phase remains behind a smoothing, and so must the stated noise. A mean of 3 x 3 pixels
// lowers the noise of single pixels to a third.
TEST(LiveTracker, TheNoiseOfTwoStageIsThatOfItsReadings) {
  const sim::Scenario scenario = small_rig();
  constexpr long kFrames = 40;
  const auto noise = [&](bool is_smooth) {
    const LiveResult out = follow(scenario, {scenario, kFrames, is_smooth}, {}, "two-stage");
    EXPECT_EQ(out.published.frames_.size(), static_cast<std::size_t>(kFrames));
    return out.published.frames_.back().rows.front().budget.noise.y;
  };
  // 780 changes of a slope, half of them independent, give the noise to 6 %. The 3 x 3 mean also lowers the modulation
  // at a pitch of 29 px, by less than 1 %.
  EXPECT_NEAR(noise(true) / noise(false), 1.0, 3.0 * 0.06);
}

// Waiting would lose frames: the thread that solves has a low priority, and the source delivers meanwhile. Five attempts,
// because a scene may be solved before a busy machine measures the first frame.
TEST(LiveTracker, AResumedRunMeasuresBeforeItsSceneIsSolved) {
  const sim::Scenario scenario = small_rig();
  MeasureOptions options;
  options.method = method_named("precise");
  options.site = sim::site_of(scenario);
  constexpr long kKept = 30;
  Measurement kept;
  RenderedCamera before(scenario, kKept);
  ObservingRun run(options, kept, {});
  while (const auto frame = before.next({})) ASSERT_TRUE(run.measure_frame((*frame)->frame, [] { return true; }));
  bool has_waited = true;
  for (int attempt = 0; attempt < 5 && has_waited; ++attempt) {
    RenderedCamera camera(scenario, kKept + 1);
    for (long n = 0; n < kKept; ++n) ASSERT_TRUE(camera.next({}));
    const auto next = camera.next({});
    ASSERT_TRUE(next);
    LiveTracker tracker(options, camera.info(), RunHooks{nullptr, nullptr, kept}, {});
    tracker.pass_over_kept();
    const auto published = tracker.measure(**next, camera);
    ASSERT_TRUE(published);
    ASSERT_EQ(published->rows.size(), 1U);
    has_waited = published->health.scenes > 0;
    if (!has_waited) {
      EXPECT_EQ(published->rows.front().status, Status::kUntrusted);
    }
  }
  EXPECT_FALSE(has_waited);
}

}  // namespace
}  // namespace moiregauge::internal
