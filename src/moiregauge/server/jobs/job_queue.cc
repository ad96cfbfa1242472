// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/jobs/job_queue.h"

#include <csignal>

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace moiregauge::internal {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kPoll(50);
constexpr milliseconds kPublish(100);                   // at most ten events a second for each job
constexpr std::size_t kMaxWaiting = 200;                // commands
constexpr std::size_t kMaxKept = 300;                   // jobs that have ended
constexpr std::size_t kMaxSampleBytes = 2 << 20;        // for each job
constexpr std::size_t kMaxLiveSampleBytes = 512 << 10;  // more than the last minute of a few targets
constexpr std::size_t kMaxLiveLine = 64 << 10;          // bytes

bool is_live(const Job& job) { return job.command.action == "live"; }
bool has_progress(const Job& job) {
  return job.command.action == "measure" || job.command.action == "solve" || is_live(job);
}

// Hidden, so that no address of the page shows it.
std::string preview_name(const Job& job) { return fmt::format(".moiregauge-preview-{}.jpg", job.id); }

std::vector<std::string> child_words(const JobCommand& command) {
  std::vector<std::string> words{own_program(), command.action};
  words.insert(words.end(), command.arguments.begin(), command.arguments.end());
  return words;
}

}  // namespace

JobQueue::JobQueue(QueueOptions options)
    : options_(std::move(options)), thread_([this](const std::stop_token& stop) { work(stop); }) {}

JobQueue::~JobQueue() {
  thread_.request_stop();
  thread_.join();
}

tl::expected<Job, std::string> JobQueue::add(JobCommand command) {
  const std::lock_guard lock(mutex_);
  const auto is_active = [](const auto& task) { return !task->job.has_ended(); };
  if (static_cast<std::size_t>(std::ranges::count_if(tasks_, is_active)) >= kMaxWaiting)
    return tl::unexpected(std::string("too many commands wait: the queue: let some of them end"));
  const bool is_taken = std::ranges::any_of(tasks_, [&](const auto& task) {
    return is_active(task) && task->job.command.action == command.action &&
           task->job.command.output == command.output && !command.output.empty();
  });
  if (is_taken)
    return tl::unexpected(
        fmt::format("a command that writes there is not finished: {}: wait for it, or cancel it", command.output));
  auto task = std::make_unique<Task>();
  task->job.id = next_id();
  task->job.command = std::move(command);
  task->is_changed = true;
  tasks_.push_back(std::move(task));
  forget_old();
  publish_entries();
  return tasks_.back()->job;
}

bool JobQueue::cancel(std::string_view id) {
  const std::lock_guard lock(mutex_);
  for (const auto& task : tasks_) {
    if (task->job.id != id) continue;
    if (task->job.state == JobState::kQueued) task->job.state = JobState::kCancelled;
    if (task->program) task->program->send_signal(SIGINT);
    task->is_cancelled = task->is_changed = true;
    publish_entries();
    return true;
  }
  return false;
}

tl::expected<Job, std::string> JobQueue::resume(std::string_view id) {
  const auto known = job(id);
  if (!known) return tl::unexpected(fmt::format("the job is unknown: {}: reload the page", id));
  if (!known->has_ended()) return tl::unexpected(fmt::format("the job has not ended: {}: wait for it", id));
  auto command = resumed(known->command);
  if (!command)
    return tl::unexpected(fmt::format("the command cannot be resumed: {}: start it again", known->command.action));
  return add(*std::move(command));
}

std::vector<Job> JobQueue::jobs() const {
  const std::lock_guard lock(mutex_);
  std::vector<Job> out;
  for (const auto& task : tasks_) out.push_back(task->job);
  return out;
}

std::optional<Job> JobQueue::job(std::string_view id) const {
  const std::lock_guard lock(mutex_);
  for (const auto& task : tasks_) {
    if (task->job.id == id) return task->job;
  }
  return std::nullopt;
}

std::string JobQueue::preview_path(const Job& job) const { return options_.folder + "/" + preview_name(job); }

std::string JobQueue::present_events() const {
  const std::lock_guard lock(mutex_);
  std::string events;
  for (const auto& task : tasks_) {
    events += event_text("job", job_json(task->job));
    if (task->job.has_ended()) continue;
    for (const std::string& event : task->samples) events += event;
  }
  return events;
}

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

// Keeps every second event of a long run, so that the curve of a page that opens later is coarse but whole. A page shows
// only the last minute of a live source.
void JobQueue::keep_samples(Task& task, const std::string& event) {
  options_.publish(event);
  task.samples.push_back(event);
  task.sample_bytes += event.size();
  if (task.sample_bytes <= (is_live(task.job) ? kMaxLiveSampleBytes : kMaxSampleBytes)) return;
  std::vector<std::string> half;
  task.sample_bytes = 0;
  const std::size_t first = is_live(task.job) ? task.samples.size() / 2 : 0, step = is_live(task.job) ? 1 : 2;
  for (std::size_t i = first; i < task.samples.size(); i += step) {
    task.sample_bytes += task.samples[i].size();
    half.push_back(std::move(task.samples[i]));
  }
  task.samples = std::move(half);
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

void JobQueue::publish_entries() const { options_.publish(event_text("entries", "{}")); }

void JobQueue::forget_old() {
  auto ended =
      static_cast<std::size_t>(std::ranges::count_if(tasks_, [](const auto& task) { return task->job.has_ended(); }));
  std::erase_if(tasks_, [&](const auto& task) {
    return ended > kMaxKept && task->job.has_ended() && !task->program && ended-- > 0;
  });
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
