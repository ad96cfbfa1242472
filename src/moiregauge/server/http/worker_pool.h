// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace moiregauge::internal {

// Runs tasks on a fixed number of threads. The number of waiting tasks is bounded.
class WorkerPool {
 public:
  WorkerPool(int threads, std::size_t max_waiting);
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;
  ~WorkerPool();  // drops waiting tasks, and waits for running ones
  // Returns false if too many tasks wait.
  [[nodiscard]] bool add(std::function<void()> task);

 private:
  void work(const std::stop_token& stop);
  const std::size_t max_waiting_;
  std::mutex mutex_;
  std::condition_variable_any has_task_;
  std::deque<std::function<void()>> tasks_;
  std::vector<std::jthread> threads_;
};

}  // namespace moiregauge::internal
