// SPDX-License-Identifier: Apache-2.0
// A recording replayed as a live source, so that everything live can be tested without a camera.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "moiregauge/run/frame_queue.h"

namespace moiregauge::internal {

// Frames that wait while one is measured. At 50 frames/s they bridge 0.16 s (chosen).
inline constexpr int kQueuedFrames = 8;

// Delivers the frames of a recording at `pace` times its own speed. A frame that finds the queue full is lost, as with a
// camera. Times and numbers are the recording's.
class PacedSource final : public LiveSource {
 public:
  // `pace` > 0. Frames up to number `passed` are delivered at once and never lost: a resumed run has measured them.
  PacedSource(std::unique_ptr<FrameSource> recording, double pace, long passed = -1, int queued = kQueuedFrames);
  [[nodiscard]] const InputInfo& info() const override { return info_; }
  [[nodiscard]] tl::expected<std::optional<LiveFrame>, SourceEnd> next(std::chrono::milliseconds timeout) override;
  [[nodiscard]] LostFrames lost() const override { return {.queue_full = queue_.lost()}; }
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> settings() const override;

 private:
  void deliver(const std::stop_token& stop);
  [[nodiscard]] bool wait_until(std::chrono::steady_clock::time_point due, const std::stop_token& stop);

  std::unique_ptr<FrameSource> recording_;  // used by the thread only, once it runs
  const double pace_;
  const long passed_;
  InputInfo info_;
  std::optional<InputInfo> final_info_;  // written before the queue ends, read after that
  FrameQueue queue_;
  std::mutex mutex_;
  std::condition_variable_any stopped_;
  std::jthread thread_;  // last: it uses all members above
};

// Delivers the frames of a recording as fast as they are measured. None is lost.
class UnpacedSource final : public LiveSource {
 public:
  explicit UnpacedSource(std::unique_ptr<FrameSource> recording) : recording_(std::move(recording)) {}
  [[nodiscard]] const InputInfo& info() const override { return recording_->info(); }
  [[nodiscard]] tl::expected<std::optional<LiveFrame>, SourceEnd> next(std::chrono::milliseconds timeout) override;
  [[nodiscard]] LostFrames lost() const override { return {}; }
  [[nodiscard]] bool is_frame_whole() const override { return recording_->is_frame_whole(); }
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> settings() const override { return {{"pace", "max"}}; }

 private:
  std::unique_ptr<FrameSource> recording_;
  std::optional<SourceEnd> end_;
};

}  // namespace moiregauge::internal
