// SPDX-License-Identifier: Apache-2.0
// Solves the scene again on a thread of its own, while frames are measured.
#pragma once

#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <thread>

#include "moiregauge/displacement/precise/tracked_scene.h"

namespace moiregauge::internal {

using ScenePtr = std::unique_ptr<const TrackedScene>;

// The measuring thread calls all functions. None waits for a solution.
class SceneSolver {
 public:
  // `reference` must outlive this object.
  SceneSolver(const Reference& reference, SolveOptions options);
  SceneSolver(const SceneSolver&) = delete;
  SceneSolver& operator=(const SceneSolver&) = delete;
  ~SceneSolver() = default;  // waits for a solution in progress

  // Returns true if a new request would begin at once. The thread rests after each solution for several times its
  // duration, so that solving takes a bounded share of a core.
  [[nodiscard]] bool is_idle() const { return is_idle_; }
  // Solves the scene of these key frames. Requires is_idle().
  void solve(std::shared_ptr<const Observations> keys);
  // Returns the scene solved since the last call; null if there is none.
  [[nodiscard]] ScenePtr take();
  // Frees a scene on the thread, because that takes as long as measuring a frame.
  void retire(ScenePtr scene);
  // Returns the number of scenes solved.
  [[nodiscard]] long solved() const { return solved_; }

 private:
  void work(const std::stop_token& stop);

  const Reference& reference_;
  const SolveOptions options_;
  std::atomic<bool> is_idle_ = true;
  std::atomic<long> solved_ = 0;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::shared_ptr<const Observations> wanted_;
  ScenePtr ready_, retired_;
  std::jthread thread_;  // last: it uses all members above
};

}  // namespace moiregauge::internal
