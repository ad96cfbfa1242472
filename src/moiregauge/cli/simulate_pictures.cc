// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/simulate_pictures.h"

#include <atomic>
#include <memory>
#include <mutex>

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include "moiregauge/cli/interrupt.h"
#include "moiregauge/cli/progress.h"
#include "moiregauge/io/png_file.h"

namespace moiregauge::cli {
namespace {

using simulator::Scenario;
using Written = tl::expected<void, std::string>;

// Keeps the first error, which stops the rest.
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

// Frames side by side: packing a PNG takes longer than drawing it.
Written write_frames(const Scenario& scenario, const PicturesPlan& plan, const std::string& folder) {
  Progress progress("simulating", plan.quiet);
  std::mutex mutex;
  FirstProblem problem;
  long done = 0;
  tbb::parallel_for(0L, scenario.frames, [&](long frame) {
    if (problem.failed() || interrupted()) return;
    const auto picture = simulator::render(scenario, frame, {.threads = 1, .area = plan.area});
    const auto path = fmt::format("{}/frames/{:06d}.png", folder, frame);
    problem.note(write_png(path, simulator::view_of(picture), scenario.sensor.bits));
    const std::scoped_lock lock(mutex);
    progress.show(++done, scenario.frames);
  });
  if (interrupted()) return stopped(done, scenario.frames);
  return problem.outcome();
}

struct Shot {
  long frame = 0;
  simulator::Picture picture;
};

// Frames are drawn side by side and written in order.
Written write_video(const Scenario& scenario, const PicturesPlan& plan, const std::string& folder) {
  auto writer = VideoWriter::create(fmt::format("{}/{}", folder, file_name_for(plan.video->codec)), *plan.video);
  if (!writer) return tl::unexpected(writer.error());
  Progress progress("simulating", plan.quiet);
  FirstProblem problem;
  long next = 0;
  const auto number = [&](tbb::flow_control& flow) -> long {
    if (next < scenario.frames && !problem.failed() && !interrupted()) return next++;
    flow.stop();
    return 0;
  };
  const auto draw = [&](long frame) {
    return std::make_shared<Shot>(Shot{frame, simulator::render(scenario, frame, {.threads = 1, .area = plan.area})});
  };
  const auto add = [&](const std::shared_ptr<Shot>& shot) {
    if (problem.failed()) return;
    problem.note((*writer)->add(simulator::view_of(shot->picture), simulator::stamp_of(scenario, shot->frame)));
    progress.show(shot->frame + 1, scenario.frames);
  };
  constexpr std::size_t kInFlight = 16;
  tbb::parallel_pipeline(kInFlight,
                         tbb::make_filter<void, long>(tbb::filter_mode::serial_in_order, number) &
                             tbb::make_filter<long, std::shared_ptr<Shot>>(tbb::filter_mode::parallel, draw) &
                             tbb::make_filter<std::shared_ptr<Shot>, void>(tbb::filter_mode::serial_in_order, add));
  if (problem.failed()) return problem.outcome();
  if (interrupted()) return stopped(next, scenario.frames);
  return (*writer)->finish();
}

}  // namespace

Written write_pictures(const Scenario& scenario, const PicturesPlan& plan, const std::string& folder) {
  tbb::task_arena arena(plan.threads > 0 ? plan.threads : tbb::task_arena::automatic);
  return arena.execute(
      [&] { return plan.video ? write_video(scenario, plan, folder) : write_frames(scenario, plan, folder); });
}

}  // namespace moiregauge::cli
