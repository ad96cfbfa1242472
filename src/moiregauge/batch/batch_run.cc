// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/batch/batch_run.h"

#include <chrono>
#include <list>
#include <optional>
#include <utility>

#include "moiregauge/batch/clip_job.h"
#include "moiregauge/results/summary.h"

namespace moiregauge::internal {
namespace {

constexpr std::chrono::milliseconds kProgressInterval{200};

bool is_failure(const ClipState& state) {
  return state.exit_code != static_cast<int>(Exit::kMeasured) && state.exit_code != static_cast<int>(Exit::kIncomplete);
}

class BatchLoop {
 public:
  BatchLoop(const BatchRequest& request, const std::vector<Clip>& clips) : request_(request), clips_(clips) {
    progress_.clips = clips.size();
  }

  tl::expected<BatchEnd, std::string> run() {
    while (next_ < clips_.size() || !jobs_.empty()) {
      progress_.running = jobs_.size();
      if (!request_.on_progress(progress_) && !is_interrupted_) stop();
      // A failure stops the other clips, but waits for them, so that their states are right.
      if (auto started = start_jobs(); !started) fail(started.error());
      wait();
      if (auto ended = collect_ended(); !ended) fail(ended.error());
    }
    progress_.running = 0;
    if (problem_) return tl::unexpected(*problem_);
    return BatchEnd{progress_, is_interrupted_};
  }

 private:
  using Step = tl::expected<void, std::string>;

  void stop() {
    is_interrupted_ = true;
    next_ = clips_.size();
    for (ClipJob& job : jobs_) job.interrupt();
  }

  void fail(const std::string& problem) {
    if (!problem_) problem_ = problem;
    stop();
  }

  // Starts clips until all places are taken. Looks at one finished clip at a time, so that progress is shown.
  Step start_jobs() {
    while (next_ < clips_.size() && jobs_.size() < static_cast<std::size_t>(request_.jobs)) {
      const Clip& clip = clips_[next_++];
      const auto state = read_state(request_.folder, clip.name);
      const Need need = need_of(clip, request_.options, state, request_.retry);
      if (need == Need::kNothing) {
        ++progress_.skipped;
        progress_.failed += is_failure(*state);
        return {};
      }
      auto job = ClipJob::start(request_.program, request_.folder, clip, request_.options, need);
      if (!job) return tl::unexpected(job.error());
      jobs_.push_back(*std::move(job));
    }
    return {};
  }

  void wait() {
    const bool has_place = next_ < clips_.size() && jobs_.size() < static_cast<std::size_t>(request_.jobs);
    if (has_place || jobs_.empty()) return;
    std::vector<RunningProgram*> programs;
    for (ClipJob& job : jobs_) programs.push_back(&job.program());
    wait_for_any(programs, kProgressInterval);
  }

  Step collect_ended() {
    for (auto job = jobs_.begin(); job != jobs_.end();) {
      const auto state = job->poll();
      if (state && !*state) {
        ++job;
        continue;
      }
      jobs_.erase(job++);
      if (!state) return tl::unexpected(state.error());
      progress_.ended += (*state)->is_finished;
      progress_.failed += (*state)->is_finished && is_failure(**state);
    }
    return {};
  }

  const BatchRequest& request_;
  const std::vector<Clip>& clips_;
  std::size_t next_ = 0;
  std::list<ClipJob> jobs_;
  BatchProgress progress_;
  bool is_interrupted_ = false;
  std::optional<std::string> problem_;
};

}  // namespace

tl::expected<BatchEnd, std::string> measure_clips(const BatchRequest& request, const std::vector<Clip>& clips) {
  return BatchLoop(request, clips).run();
}

}  // namespace moiregauge::internal
