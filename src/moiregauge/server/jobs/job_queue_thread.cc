// SPDX-License-Identifier: Apache-2.0
// The thread that starts the commands and collects what they write.
#include <csignal>

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/server/jobs/job_queue.h"

namespace moiregauge::internal {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kPoll(50);
constexpr milliseconds kPublish(100);                   // at most ten events a second for each job
constexpr std::size_t kMaxSampleBytes = 2 << 20;        // for each job
constexpr std::size_t kMaxLiveSampleBytes = 512 << 10;  // more than the last minute of a few targets
constexpr std::size_t kMaxLiveLine = 64 << 10;          // bytes

bool is_live(const Job& job) { return job.command.action == "live"; }
bool has_progress(const Job& job) {
  return job.command.action == "measure" || job.command.action == "solve" || is_live(job);
}

std::vector<std::string> child_words(const JobCommand& command) {
  std::vector<std::string> words{own_program(), command.action};
  words.insert(words.end(), command.arguments.begin(), command.arguments.end());
  return words;
}

}  // namespace

void JobQueue::work(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    {
      const std::lock_guard lock(mutex_);
      start_waiting();
    }
    wait(kPoll);
    const std::lock_guard lock(mutex_);
    for (const auto& task : tasks_) {
      if (task->program) collect(*task);
    }
    publish_changes();
  }
  end_all();
}

void JobQueue::start_waiting() {
  const auto running =
      std::ranges::count_if(tasks_, [](const auto& task) { return task->program && !is_live(task->job); });
  long free = options_.at_once - running;
  for (const auto& task : tasks_) {
    if (task->job.state != JobState::kQueued || (!is_live(task->job) && free <= 0)) continue;
    if (!is_live(task->job)) --free;
    start(*task);
  }
}

void JobQueue::start(Task& task) {
  ChildRequest request;
  request.argv = child_words(task.job.command);
  // Options for this caller only: they change no result, so the command that the page shows has none of them.
  if (has_progress(task.job)) request.argv.insert(request.argv.end(), {"--progress", "json"});
  if (is_live(task.job)) request.argv.insert(request.argv.end(), {"--json", "--preview", preview_name(task.job)});
  request.folder = options_.folder;
  request.reads_stdout = true;
  task.begin = Clock::now();
  task.is_changed = true;
  auto program = RunningProgram::start(request);
  if (!program) {
    task.job.state = JobState::kFailed;
    task.job.add_line("error: the command could not start: " + program.error());
    return;
  }
  task.program.emplace(*std::move(program));
  task.job.state = JobState::kRunning;
  publish_entries();
}

// The children may only be waited for on this thread. `tasks_` is not changed by others in a way that ends one.
void JobQueue::wait(milliseconds timeout) {
  std::vector<RunningProgram*> programs;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& task : tasks_) {
      if (task->program) programs.push_back(&*task->program);
    }
  }
  if (programs.empty())
    std::this_thread::sleep_for(timeout);
  else
    wait_for_any(programs, timeout);
}

void JobQueue::collect(Task& task) {
  const auto end = task.program->wait(milliseconds(0));
  for (const std::string& line : task.program->take_stderr_lines()) take_line(task, line);
  task.output += task.program->take_stdout();
  if (!is_live(task.job)) task.output.clear();
  for (std::size_t at = 0; (at = task.output.find('\n')) != std::string::npos;) {
    take_live_line(task, task.output.substr(0, at));
    task.output.erase(0, at + 1);
  }
  if (task.output.size() > kMaxLiveLine) task.output.clear();
  task.job.seconds = std::chrono::duration<double>(Clock::now() - task.begin).count();
  if (end) finish(task, *end);
}

void JobQueue::take_line(Task& task, std::string_view line) {
  ChildLine read = read_child_line(line);
  task.is_changed = true;
  switch (read.kind) {
    case ChildLine::Kind::kMessage:
      task.job.add_line(std::move(read.text));
      break;
    case ChildLine::Kind::kProgress:
      task.job.frames_done = read.done;
      task.job.frames = read.expected;
      task.job.stage = std::move(read.stage);
      break;
    case ChildLine::Kind::kSamples:
      keep_samples(task,
                   event_text("samples", fmt::format("{{\"id\":\"{}\",\"marker\":{}}}", task.job.id, read.samples)));
      break;
    case ChildLine::Kind::kView:  // not kept for pages that open later: the next one comes soon
      options_.publish(event_text("view", fmt::format("{{\"id\":\"{}\",\"frame\":{},\"reference_from_frame\":{}}}",
                                                      task.job.id, read.frame, read.view)));
      break;
  }
}

void JobQueue::take_live_line(Task& task, std::string line) {
  task.job.live_line = std::move(line);
  options_.publish(event_text(
      "live", fmt::format("{{\"id\":\"{}\",\"state\":\"running\",\"line\":{}}}", task.job.id, task.job.live_line)));
}

void JobQueue::keep_samples(Task& task, std::string event) {
  options_.publish(event);
  if (is_live(task.job))
    task.samples.add(std::move(event), KeptSamples::Keep::kNewest, kMaxLiveSampleBytes);
  else
    task.samples.add(std::move(event), KeptSamples::Keep::kWhole, kMaxSampleBytes);
}

void JobQueue::finish(Task& task, const ChildEnd& end) {
  constexpr int kMeasured = 0, kIncomplete = 5, kInterrupted = 130, kSourceLost = 7;
  Job& job = task.job;
  task.program.reset();
  task.samples.clear();
  task.is_changed = true;
  task.published = {};
  job.exit_code = end.exit_code;
  if (end.exit_code < 0) job.add_line(fmt::format("error: the command ended by signal {}", end.signal));
  const bool is_good = end.exit_code == kMeasured || end.exit_code == kIncomplete;
  if (end.exit_code == kInterrupted || (task.is_cancelled && !is_good))
    job.state = JobState::kCancelled;
  else
    job.state = is_good ? JobState::kDone : JobState::kFailed;
  if (is_good && job.frames > job.frames_done && job.stage == "solving") job.frames_done = job.frames;
  if (is_live(job))
    options_.publish(event_text(
        "live", fmt::format("{{\"id\":\"{}\",\"state\":\"{}\",\"line\":{{\"type\":\"end\",\"exit_code\":{}}}}}", job.id,
                            end.exit_code == kSourceLost ? "lost" : "ended", end.exit_code)));
  publish_entries();
}

void JobQueue::publish_changes() {
  const auto now = Clock::now();
  for (const auto& task : tasks_) {
    if (!task->is_changed || now - task->published < kPublish) continue;
    task->is_changed = false;
    task->published = now;
    options_.publish(event_text("job", job_json(task->job)));
  }
}

void JobQueue::end_all() {
  const std::lock_guard lock(mutex_);
  for (const auto& task : tasks_) {
    if (task->program) task->program->send_signal(SIGINT);
  }
  const auto deadline = Clock::now() + options_.patience;
  for (const auto& task : tasks_) {
    if (!task->program) continue;
    const auto left = std::chrono::duration_cast<milliseconds>(deadline - Clock::now());
    (void)task->program->wait(std::max(left, milliseconds(0)));
    task->program.reset();  // kills what has not ended
  }
}

}  // namespace moiregauge::internal
