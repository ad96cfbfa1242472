// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/scene_solver.h"

#include <chrono>
#include <utility>

#include "moiregauge/base/thread_priority.h"

namespace moiregauge::internal {
namespace {

using Clock = std::chrono::steady_clock;

// Rest after a solution, relative to its duration. Solving then takes at most a tenth of a core (chosen).
constexpr int kRest = 9;

}  // namespace

SceneSolver::SceneSolver(const Reference& reference, SolveOptions options)
    : reference_(reference), options_(options), thread_([this](const std::stop_token& stop) { work(stop); }) {}

void SceneSolver::solve(std::shared_ptr<const Observations> keys) {
  is_idle_ = false;
  {
    const std::lock_guard lock(mutex_);
    wanted_ = std::move(keys);
  }
  wake_.notify_one();
}

ScenePtr SceneSolver::take() {
  const std::lock_guard lock(mutex_);
  return std::move(ready_);
}

void SceneSolver::retire(ScenePtr scene) {
  const std::lock_guard lock(mutex_);
  retired_ = std::move(scene);
}

void SceneSolver::work(const std::stop_token& stop) {
  lower_thread_priority();
  while (!stop.stop_requested()) {
    std::shared_ptr<const Observations> keys;
    ScenePtr freed;
    {
      std::unique_lock lock(mutex_);
      if (!wake_.wait(lock, stop, [this] { return wanted_ != nullptr; })) return;
      keys = std::exchange(wanted_, nullptr);
      freed = std::move(retired_);
    }
    freed.reset();
    const auto begin = Clock::now();
    auto scene = std::make_unique<const TrackedScene>(reference_, std::move(keys), options_);
    const auto end = Clock::now();
    std::unique_lock lock(mutex_);
    ready_.swap(scene);
    ++solved_;
    wake_.wait_until(lock, stop, end + kRest * (end - begin), [] { return false; });
    is_idle_ = true;
    lock.unlock();  // before an unused scene is freed
  }
}

}  // namespace moiregauge::internal
