// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/jobs/job_queue.h"

#include <csignal>

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace moiregauge::internal {
namespace {

constexpr std::size_t kMaxWaiting = 200;  // commands
constexpr std::size_t kMaxKept = 300;     // jobs that have ended

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
    for (const std::string& event : task->samples.events()) events += event;
  }
  return events;
}

void JobQueue::publish_entries() const { options_.publish(event_text("entries", "{}")); }

void JobQueue::forget_old() {
  auto ended =
      static_cast<std::size_t>(std::ranges::count_if(tasks_, [](const auto& task) { return task->job.has_ended(); }));
  std::erase_if(tasks_, [&](const auto& task) {
    return ended > kMaxKept && task->job.has_ended() && !task->program && ended-- > 0;
  });
}

}  // namespace moiregauge::internal
