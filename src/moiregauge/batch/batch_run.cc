// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/batch/batch_run.h"

#include <algorithm>
#include <chrono>
#include <list>
#include <optional>
#include <thread>
#include <utility>

#include "moiregauge/batch/clip_job.h"
#include "moiregauge/io/run_dir/unfinished_run.h"
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
    while (next_ < clips_.size() || !jobs_.empty() || may_wait()) {
      progress_.running = jobs_.size();
      progress_.busy = busy_.size();
      if (!request_.on_progress(progress_) && !is_interrupted_) stop();
      // A failure stops the other clips, but waits for them, so that their states are right.
      if (auto started = start_jobs(); !started) fail(started.error());
      wait();
      if (auto ended = collect_ended(); !ended) fail(ended.error());
    }
    progress_.running = 0;
    if (problem_) return tl::unexpected(*problem_);
    BatchEnd end{progress_, is_interrupted_, {}};
    for (const Clip* clip : busy_) end.busy.push_back(clip->name);
    return end;
  }

 private:
  using Step = tl::expected<void, std::string>;
  using Clock = std::chrono::steady_clock;

  void stop() {
    is_interrupted_ = true;
    next_ = clips_.size();
    for (ClipJob& job : jobs_) job.interrupt();
  }

  void fail(const std::string& problem) {
    if (!problem_) problem_ = problem;
    stop();
  }

  [[nodiscard]] bool has_place() const { return jobs_.size() < static_cast<std::size_t>(request_.jobs); }

  // Returns true while a busy clip may become free. The patience begins when nothing else is in progress.
  bool may_wait() {
    if (busy_.empty() || is_interrupted_) return false;
    if (!idle_since_) idle_since_ = Clock::now();
    return Clock::now() - *idle_since_ <= request_.patience;
  }

  [[nodiscard]] bool is_busy(const Clip& clip) const {
    return is_measured_elsewhere(place_of_run(request_.folder.run(clip.name).string()));
  }

  // Returns the next clip to look at, or none. Busy clips come after all others, when they are free.
  const Clip* next_clip() {
    if (next_ < clips_.size()) return &clips_[next_++];
    if (is_interrupted_) return nullptr;
    const auto free = std::find_if(busy_.begin(), busy_.end(), [this](const Clip* clip) { return !is_busy(*clip); });
    if (free == busy_.end()) return nullptr;
    const Clip* clip = *free;
    busy_.erase(free);
    return clip;
  }

  // Starts clips until all places are taken. Looks at one finished clip at a time, so that progress is shown.
  Step start_jobs() {
    while (has_place()) {
      const Clip* next = next_clip();
      if (next == nullptr) return {};
      const Clip& clip = *next;
      const auto state = read_state(request_.folder, clip.name);
      const Need need = need_of(clip, request_.options, state, request_.retry);
      if (need == Need::kNothing) {
        ++progress_.skipped;
        progress_.failed += is_failure(*state);
        return {};
      }
      if (is_busy(clip)) {
        busy_.push_back(&clip);
        continue;
      }
      auto job = ClipJob::start(request_.program, request_.folder, clip, request_.options, need);
      if (!job) return tl::unexpected(job.error());
      jobs_.push_back(*std::move(job));
      idle_since_.reset();
    }
    return {};
  }

  void wait() {
    if (next_ < clips_.size() && has_place()) return;
    if (jobs_.empty()) {
      if (!busy_.empty()) std::this_thread::sleep_for(std::min(kProgressInterval, request_.patience));
      return;
    }
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
  std::list<const Clip*> busy_;                    // measured by other processes
  std::optional<Clock::time_point> idle_since_{};  // busy clips alone are left
  BatchProgress progress_;
  bool is_interrupted_ = false;
  std::optional<std::string> problem_;
};

}  // namespace

tl::expected<BatchEnd, std::string> measure_clips(const BatchRequest& request, const std::vector<Clip>& clips) {
  return BatchLoop(request, clips).run();
}

}  // namespace moiregauge::internal
