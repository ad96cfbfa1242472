// SPDX-License-Identifier: Apache-2.0
// Work in the background of a live run, one task after the other, in the order in which they were added.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace moiregauge::internal {

class TaskQueue {
 public:
  using Task = std::function<void()>;
  TaskQueue();
  TaskQueue(const TaskQueue&) = delete;
  TaskQueue& operator=(const TaskQueue&) = delete;
  ~TaskQueue() = default;  // completes all tasks
  void add(Task task);
  // Returns the number of tasks that are not completed.
  [[nodiscard]] std::size_t pending() const;
  // Waits until all tasks are completed.
  void wait();

 private:
  void work(const std::stop_token& stop);
  mutable std::mutex mutex_;
  std::condition_variable_any added_, done_;
  std::deque<Task> tasks_;  // the first one is in progress
  std::jthread thread_;     // last: it uses all members above
};

}  // namespace moiregauge::internal
