// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/live/task_queue.h"

#include <utility>

#include "moiregauge/base/thread_priority.h"

namespace moiregauge::internal {

TaskQueue::TaskQueue() : thread_([this](const std::stop_token& stop) { work(stop); }) {}

void TaskQueue::add(Task task) {
  {
    const std::lock_guard lock(mutex_);
    tasks_.push_back(std::move(task));
  }
  added_.notify_one();
}

std::size_t TaskQueue::pending() const {
  const std::lock_guard lock(mutex_);
  return tasks_.size();
}

void TaskQueue::wait() {
  std::unique_lock lock(mutex_);
  done_.wait(lock, [this] { return tasks_.empty(); });
}

void TaskQueue::work(const std::stop_token& stop) {
  lower_thread_priority();
  std::unique_lock lock(mutex_);
  while (added_.wait(lock, stop, [this] { return !tasks_.empty(); })) {
    const Task task = std::move(tasks_.front());
    lock.unlock();
    task();
    lock.lock();
    tasks_.pop_front();
    done_.notify_all();
  }
}

}  // namespace moiregauge::internal
