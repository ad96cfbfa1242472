// SPDX-License-Identifier: Apache-2.0
// Commands that the page has started. Each is a child process of this program.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "moiregauge/base/child_process.h"
#include "moiregauge/server/jobs/job.h"
#include "moiregauge/server/jobs/kept_samples.h"

namespace moiregauge::internal {

struct QueueOptions {
  std::string folder;                              // working folder of the commands
  int at_once = 1;                                 // commands that run at the same time, besides live ones
  std::chrono::milliseconds patience{30'000};      // for commands to end when the queue is closed
  std::function<void(std::string event)> publish;  // receives events for the page
};

class JobQueue {
 public:
  explicit JobQueue(QueueOptions options);
  JobQueue(const JobQueue&) = delete;
  JobQueue& operator=(const JobQueue&) = delete;
  ~JobQueue();  // stops all commands as Ctrl-C does, so that runs stay resumable

  // Adds a command. Fails with "what: where: what to do": too many wait, or one of them writes to the same place.
  [[nodiscard]] tl::expected<Job, std::string> add(JobCommand command);
  // Stops a command as Ctrl-C does. Returns false for an unknown id.
  [[nodiscard]] bool cancel(std::string_view id);
  // Adds a cancelled or failed command again, with --resume. Fails with the reason.
  [[nodiscard]] tl::expected<Job, std::string> resume(std::string_view id);
  // Returns all jobs, oldest first.
  [[nodiscard]] std::vector<Job> jobs() const;
  [[nodiscard]] std::optional<Job> job(std::string_view id) const;
  // Returns the path of the newest picture of a live source. The file may be missing.
  [[nodiscard]] std::string preview_path(const Job& job) const;
  // Returns events that bring a new page up to date: all jobs and the samples of those that run.
  [[nodiscard]] std::string present_events() const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Task {
    Job job;
    std::optional<RunningProgram> program;
    Clock::time_point begin{}, published{};
    bool is_changed = false;
    bool is_cancelled = false;
    std::string output;  // unfinished line of stdout
    KeptSamples samples;
  };

  [[nodiscard]] std::string next_id() { return std::to_string(++last_id_); }
  void forget_old();
  void publish_entries() const;

  // job_queue_thread.cc: the thread that runs the commands.
  void work(const std::stop_token& stop);
  void start_waiting();
  void start(Task& task);
  void wait(std::chrono::milliseconds timeout);
  void collect(Task& task);
  void take_line(Task& task, std::string_view line);
  void take_live_line(Task& task, std::string line);
  void keep_samples(Task& task, std::string event);
  void finish(Task& task, const ChildEnd& end);
  void publish_changes();
  void end_all();

  const QueueOptions options_;
  mutable std::mutex mutex_;
  std::vector<std::unique_ptr<Task>> tasks_;  // oldest first
  long last_id_ = 0;
  std::jthread thread_;  // last: it uses all members above, and starts the children
};

}  // namespace moiregauge::internal
