// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/reproduce/simulate_pictures.h"

#include <atomic>
#include <memory>
#include <mutex>
#include <utility>

#include <fmt/format.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include "moiregauge/cli/common/interrupt.h"
#include "moiregauge/cli/common/progress.h"
#include "moiregauge/io/pictures/png_file.h"
#include "moiregauge/simulator/recorder.h"

namespace moiregauge::internal::cli {
namespace {

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

Written stopped(long done, long all) { return tl::unexpected(fmt::format("stopped at frame {} of {}", done, all)); }

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
  ShotMaker(const Scenario& scenario, const PicturesPlan& plan, const FirstProblem& problem)
      : scenario_(scenario), plan_(plan), problem_(problem), filter_(scenario) {}
  [[nodiscard]] tbb::filter<void, ShotPointer> filter() {
    const auto number = [this](tbb::flow_control& flow) -> long {
      if (next_ < scenario_.frames && !problem_.failed() && !interrupted()) return next_++;
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
  [[nodiscard]] long begun() const { return next_; }

 private:
  const Scenario& scenario_;
  const PicturesPlan& plan_;
  const FirstProblem& problem_;
  simulator::TemporalFilter filter_;
  long next_ = 0;
};

constexpr std::size_t kInFlight = 16;

// Writes PNG files in parallel, because packing one takes longer than drawing it.
Written write_frames(const Scenario& scenario, const PicturesPlan& plan, const std::string& folder) {
  Progress progress("simulating", plan.quiet);
  std::mutex mutex;
  FirstProblem problem;
  ShotMaker shots(scenario, plan, problem);
  long done = 0;
  const auto pack = [&](const ShotPointer& shot) {
    const auto path = fmt::format("{}/frames/{:06d}.png", folder, shot->frame);
    problem.note(write_png(path, simulator::view_of(shot->picture), scenario.sensor.bits, tone_of(scenario)));
    const std::scoped_lock lock(mutex);
    progress.show(++done, scenario.frames);
  };
  tbb::parallel_pipeline(kInFlight, shots.filter() & make_filter<ShotPointer, void>(filter_mode::parallel, pack));
  if (interrupted()) return stopped(done, scenario.frames);
  return problem.outcome();
}

Written write_video(const Scenario& scenario, const PicturesPlan& plan, const std::string& folder) {
  auto writer = VideoWriter::create(fmt::format("{}/{}", folder, file_name_for(plan.video->codec)), *plan.video);
  if (!writer) return tl::unexpected(writer.error());
  Progress progress("simulating", plan.quiet);
  FirstProblem problem;
  ShotMaker shots(scenario, plan, problem);
  const auto add = [&](const ShotPointer& shot) {
    if (problem.failed()) return;
    problem.note((*writer)->add(simulator::view_of(shot->picture), simulator::stamp_of(scenario, shot->frame)));
    progress.show(shot->frame + 1, scenario.frames);
  };
  tbb::parallel_pipeline(kInFlight, shots.filter() & make_filter<ShotPointer, void>(filter_mode::serial_in_order, add));
  if (problem.failed()) return problem.outcome();
  if (interrupted()) return stopped(shots.begun(), scenario.frames);
  return (*writer)->finish();
}

}  // namespace

Written write_pictures(const Scenario& scenario, const PicturesPlan& plan, const std::string& folder) {
  tbb::task_arena arena(plan.threads > 0 ? plan.threads : tbb::task_arena::automatic);
  return arena.execute(
      [&] { return plan.video ? write_video(scenario, plan, folder) : write_frames(scenario, plan, folder); });
}

}  // namespace moiregauge::internal::cli
