// SPDX-License-Identifier: Apache-2.0
// Measures a camera of 4096 x 2168 px, 8 bits raw, in memory. Prints lost frames, share of a core, latency from the
// complete frame to its rows, and memory. The run is stored on disk.
//
//     live_bench FRAMES_PER_S SECONDS FOLDER      FRAMES_PER_S 0: as fast as frames are measured
#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "moiregauge/app/live/live_store.h"
#include "moiregauge/live/clocks.h"
#include "moiregauge/live/live_loop.h"
#include "moiregauge/simulator/simulator.h"

namespace moiregauge::internal {
namespace {

constexpr int kWidth = 4096, kHeight = 2168;
constexpr long kFrames = 24;  // 213 MB: more than most last-level caches
constexpr long kStep = 1;     // frames of the scenario between frames of the camera
constexpr long kQueued = 8;   // frames that a camera's driver keeps
constexpr double kNsPerS = 1e9, kMega = 1e6;

simulator::Scenario scenario_of_camera() {
  auto scenario = *simulator::built_in("rig-1xyz");
  scenario.camera.cx += 0.5 * (kWidth - scenario.camera.width);
  scenario.camera.cy += 0.5 * (kHeight - scenario.camera.height);
  scenario.camera.width = kWidth;
  scenario.camera.height = kHeight;
  return scenario;
}

// Shows the frames forwards and backwards, so that nothing jumps. Its driver keeps complete frames in buffers of its own,
// and drops those that come while all are in use.
class MemoryCamera final : public LiveSource {
 public:
  MemoryCamera(const std::vector<Image<std::uint8_t>>& pictures, double fps, double seconds)
      : pictures_(pictures), fps_(fps), end_s_(seconds) {
    info_.path = "memory";
    info_.width = kWidth;
    info_.height = kHeight;
    info_.codec = "raw";
    info_.time_source = "host";
    constexpr double kNominal = 42.0;
    info_.fps = fps > 0.0 ? fps : kNominal;
  }
  [[nodiscard]] const InputInfo& info() const override { return info_; }
  [[nodiscard]] LostFrames lost() const override {
    if (fps_ == 0.0 || begin_ns_ == 0) return {};
    return {.queue_full = lost_ + std::max(0L, complete_frames() - next_ - kQueued)};
  }
  [[nodiscard]] tl::expected<std::optional<LiveFrame>, SourceEnd> next(std::chrono::milliseconds /*timeout*/) override {
    if (begin_ns_ == 0) begin_ns_ = steady_ns();
    const double now_s = static_cast<double>(steady_ns() - begin_ns_) / kNsPerS;
    if (now_s > end_s_) return tl::unexpected(SourceEnd{});
    if (fps_ > 0.0) wait(now_s);
    LiveFrame live;
    live.frame.number = next_;
    live.frame.time_s = static_cast<double>(next_) / info_.fps;
    const long k = next_ % (2 * kFrames - 2);
    live.frame.luma = pictures_[static_cast<std::size_t>(std::min(k, 2 * kFrames - 2 - k))].view();
    live.host_ns =
        fps_ > 0.0 ? begin_ns_ + static_cast<std::int64_t>(kNsPerS * static_cast<double>(next_) / fps_) : steady_ns();
    ++next_;
    return live;
  }

 private:
  [[nodiscard]] long complete_frames() const {
    return static_cast<long>(static_cast<double>(steady_ns() - begin_ns_) / kNsPerS * fps_) + 1;
  }
  // Waits for the next frame, or drops those for which the driver had no buffer.
  void wait(double now_s) {
    const long complete = complete_frames();
    if (complete - next_ > kQueued) {
      lost_ += complete - next_ - kQueued;
      next_ = complete - kQueued;
    }
    const double early_s = static_cast<double>(next_) / fps_ - now_s;
    if (early_s > 0.0) std::this_thread::sleep_for(std::chrono::duration<double>(early_s));
  }

  const std::vector<Image<std::uint8_t>>& pictures_;
  const double fps_, end_s_;
  InputInfo info_;
  std::int64_t begin_ns_ = 0;
  long next_ = 0;
  long lost_ = 0;
};

double cpu_s() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_usec) / kMega;
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

double resident_mb() {
  std::ifstream file("/proc/self/statm");
  long pages = 0, resident = 0;
  file >> pages >> resident;
  constexpr double kPage = 4096.0;
  return static_cast<double>(resident) * kPage / kMega;
}

// Counts from the 21st frame after the reference frame on: templates are learned only once.
class Meter final : public Publisher {
 public:
  void start(const LiveRun& /*run*/) override {}
  void finish(double /*seconds*/) override {}
  void put(const PublishedFrame& frame) override {
    latency_ms_.push_back(static_cast<double>(steady_ns() - frame.host_ns) / kMega);
    constexpr std::size_t kStartUp = 20;
    if (latency_ms_.size() == kStartUp) {
      cpu_s_ = cpu_s();
      begin_ns_ = steady_ns();
      resident_mb_ = resident_mb();
      lost_ = frame.health.lost.frames();
    }
    last_ = frame.health;
  }
  void print(double fps) {
    constexpr std::size_t kStartUp = 20;
    if (latency_ms_.size() <= kStartUp) return;
    const double elapsed_s = static_cast<double>(steady_ns() - begin_ns_) / kNsPerS;
    std::vector<double> late(latency_ms_.begin() + kStartUp, latency_ms_.end());
    std::ranges::sort(late);
    const auto quantile = [&](double share) { return late[static_cast<std::size_t>(share * double(late.size() - 1))]; };
    const double rate = static_cast<double>(late.size()) / elapsed_s;
    fmt::print(
        "camera {} frames/s, {:.0f} s: measured {:.1f} frames/s, lost {} (and {} while the reference frame was "
        "learned); "
        "{:.1f} % of a core; latency p50 {:.2f} ms, p99 {:.2f} ms, max {:.1f} ms; scenes {}; rows ok {} of {}; memory "
        "{:.0f} "
        "MB, then {:.0f} MB\n",
        fps, elapsed_s, rate, last_.lost.frames() - lost_, last_.lost.starting, 100.0 * (cpu_s() - cpu_s_) / elapsed_s,
        quantile(0.5), quantile(0.99), late.back(), last_.scenes, last_.ok_rows, last_.rows, resident_mb_,
        resident_mb());
  }

 private:
  std::vector<double> latency_ms_;
  double cpu_s_ = 0.0, resident_mb_ = 0.0;
  std::int64_t begin_ns_ = 0;
  long lost_ = 0;
  LiveHealth last_;
};

int run(double fps, double seconds, const std::string& folder) {
  const simulator::Scenario scenario = scenario_of_camera();
  std::vector<Image<std::uint8_t>> pictures;
  for (long n = 0; n < kFrames; ++n)
    pictures.push_back(simulator::render8(scenario, n * kStep, {.area = simulator::Area::kMarkersOnly}));
  MemoryCamera camera(pictures, fps, seconds);
  MeasureOptions options;
  options.method = method_named("precise");
  options.site = simulator::site_of(scenario);
  std::optional<LiveTracker> tracker;
  LiveStore store({.folder = folder}, {"bench", "memory", {}, false, camera.info()}, options,
                  [] { return SegmentEnd{}; });
  if (const auto opened = store.open(); !opened) {
    fmt::print(stderr, "error: {}\n", opened.error().message);
    return 1;
  }
  tracker.emplace(options, camera.info(), RunHooks{nullptr, &store, {}}, KeyFrameLimits{});
  Meter meter;
  LiveLoopHooks hooks;
  hooks.publishers = {&store, &meter};
  hooks.on_reference = [&] { store.show_reference(tracker->log()); };
  (void)run_live_loop(camera, *tracker, hooks);
  meter.print(fps);
  return 0;
}

}  // namespace
}  // namespace moiregauge::internal

int main(int argc, char** argv) {
  constexpr int kArguments = 4;
  if (argc != kArguments) {
    std::fputs("live_bench FRAMES_PER_S SECONDS FOLDER\n", stderr);
    return 2;
  }
  return moiregauge::internal::run(std::atof(argv[1]), std::atof(argv[2]), argv[3]);
}
