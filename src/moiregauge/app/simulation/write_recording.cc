// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/simulation/write_recording.h"

#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include "moiregauge/io/config/site_file.h"
#include "moiregauge/io/config/truth_file.h"
#include "moiregauge/io/pictures/png_file.h"
#include "moiregauge/simulator/recorder.h"

namespace moiregauge::internal {
namespace {

namespace fs = std::filesystem;
using simulator::Scenario;
using Written = tl::expected<void, std::string>;

// Keeps the first error, which stops the other threads.
class FirstProblem {
 public:
  void note(const Written& written) {
    if (written) return;
    const std::scoped_lock lock(mutex_);
    if (!problem_) problem_ = written.error();
    failed_ = true;
  }
  [[nodiscard]] bool failed() const { return failed_; }
  [[nodiscard]] Written outcome() const {
    if (problem_) return tl::unexpected(*problem_);
    return {};
  }

 private:
  std::mutex mutex_;
  std::optional<std::string> problem_;
  std::atomic<bool> failed_{false};
};

// Counts frames for the caller, which may stop.
class FrameCount {
 public:
  FrameCount(const RecordingPlan& plan, long frames) : plan_(plan), frames_(frames) {}
  void add_one() {
    const std::scoped_lock lock(mutex_);
    ++done_;
    if (plan_.on_progress && !is_stopped_ && !plan_.on_progress(done_, frames_)) is_stopped_ = true;
  }
  [[nodiscard]] bool is_stopped() const { return is_stopped_; }
  [[nodiscard]] Written stopped() const {
    return tl::unexpected(fmt::format("stopped at frame {} of {}", done_, frames_));
  }

 private:
  const RecordingPlan& plan_;
  long frames_;
  long done_ = 0;
  std::mutex mutex_;
  std::atomic<bool> is_stopped_{false};
};

// Tags images whose grey levels are proportional to light.
PngTone tone_of(const Scenario& scenario) {
  return simulator::stores_light(scenario) ? PngTone::kLinear : PngTone::kUnstated;
}

struct Shot {
  long frame = 0;
  simulator::Picture picture;
};
using ShotPointer = std::shared_ptr<Shot>;
using tbb::filter_mode;
using tbb::make_filter;

// Draws frames in parallel. Camera processing that depends on earlier frames follows in order.
class ShotMaker {
 public:
  ShotMaker(const Scenario& scenario, const RecordingPlan& plan, const FirstProblem& problem, const FrameCount& count)
      : scenario_(scenario), plan_(plan), problem_(problem), count_(count), filter_(scenario) {}
  [[nodiscard]] tbb::filter<void, ShotPointer> filter() {
    const auto number = [this](tbb::flow_control& flow) -> long {
      if (next_ < scenario_.frames && !problem_.failed() && !count_.is_stopped()) return next_++;
      flow.stop();
      return 0;
    };
    const auto draw = [this](long frame) {
      return std::make_shared<Shot>(
          Shot{frame, simulator::render_still(scenario_, frame, {.threads = 1, .area = plan_.area})});
    };
    const auto look_back = [this](ShotPointer shot) {
      if (simulator::has_temporal_steps(scenario_)) shot->picture = filter_.next(std::move(shot->picture));
      return shot;
    };
    return make_filter<void, long>(filter_mode::serial_in_order, number) &
           make_filter<long, ShotPointer>(filter_mode::parallel, draw) &
           make_filter<ShotPointer, ShotPointer>(filter_mode::serial_in_order, look_back);
  }

 private:
  const Scenario& scenario_;
  const RecordingPlan& plan_;
  const FirstProblem& problem_;
  const FrameCount& count_;
  simulator::TemporalFilter filter_;
  long next_ = 0;
};

constexpr std::size_t kInFlight = 16;

// Writes PNG files in parallel, because packing one takes longer than drawing it.
Written write_frames(const Scenario& scenario, const RecordingPlan& plan, const std::string& folder) {
  FirstProblem problem;
  FrameCount count(plan, scenario.frames);
  ShotMaker shots(scenario, plan, problem, count);
  const auto pack = [&](const ShotPointer& shot) {
    const auto path = fmt::format("{}/frames/{:06d}.png", folder, shot->frame);
    problem.note(write_png(path, simulator::view_of(shot->picture), scenario.sensor.bits, tone_of(scenario)));
    count.add_one();
  };
  tbb::parallel_pipeline(kInFlight, shots.filter() & make_filter<ShotPointer, void>(filter_mode::parallel, pack));
  return count.is_stopped() ? count.stopped() : problem.outcome();
}

Written write_video(const Scenario& scenario, const RecordingPlan& plan, const std::string& folder) {
  auto writer = VideoWriter::create(fmt::format("{}/{}", folder, file_name_for(plan.video->codec)), *plan.video);
  if (!writer) return tl::unexpected(writer.error());
  FirstProblem problem;
  FrameCount count(plan, scenario.frames);
  ShotMaker shots(scenario, plan, problem, count);
  const auto add = [&](const ShotPointer& shot) {
    if (problem.failed()) return;
    problem.note((*writer)->add(simulator::view_of(shot->picture), simulator::stamp_of(scenario, shot->frame)));
    count.add_one();
  };
  tbb::parallel_pipeline(kInFlight, shots.filter() & make_filter<ShotPointer, void>(filter_mode::serial_in_order, add));
  if (problem.failed()) return problem.outcome();
  return count.is_stopped() ? count.stopped() : (*writer)->finish();
}

Written write_images(const Scenario& scenario, const RecordingPlan& plan, const std::string& folder) {
  tbb::task_arena arena(plan.threads > 0 ? plan.threads : tbb::task_arena::automatic);
  return arena.execute(
      [&] { return plan.video ? write_video(scenario, plan, folder) : write_frames(scenario, plan, folder); });
}

Written clear_recording(const fs::path& output, bool for_video) {
  std::error_code error;
  fs::remove_all(output / "frames", error);
  for (const char* name : {"truth.csv", "video.mkv", "video.mp4"}) fs::remove(output / name, error);
  fs::create_directories(for_video ? output : output / "frames", error);
  if (error) return tl::unexpected(fmt::format("{}: {}", output.string(), error.message()));
  return {};
}

}  // namespace

Written write_recording(const Scenario& scenario, const RecordingPlan& plan, const std::string& folder) {
  const fs::path output = folder;
  return clear_recording(output, plan.video.has_value())
      .and_then([&] { return write_text((output / "truth-camera.toml").string(), truth_camera_toml(scenario)); })
      .and_then([&] { return write_text((output / "site.toml").string(), write_site(simulator::site_of(scenario))); })
      .and_then([&] { return write_images(scenario, plan, folder); })
      .and_then([&] { return write_text((output / "truth.csv").string(), truth_csv(scenario)); });
}

}  // namespace moiregauge::internal
