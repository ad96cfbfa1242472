// SPDX-License-Identifier: Apache-2.0
// Bounded queue of frames between the thread of a source and the thread that measures. Buffers are allocated once.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <vector>

#include "moiregauge/run/live_source.h"

namespace moiregauge::internal {

class FrameQueue {
 public:
  // Holds up to `capacity` waiting frames, and the one that is measured. Requires capacity >= 1.
  explicit FrameQueue(int capacity);

  // The producer's thread:
  // Copies a frame. Never waits. Returns false and counts the frame as lost if the queue is full.
  bool put(const LiveFrame& frame);
  // Copies a frame after waiting for space. Returns false after a stop request.
  bool put_waiting(const LiveFrame& frame, const std::stop_token& stop);
  // Ends the queue. Frames that wait are still delivered.
  void end(SourceEnd end);

  // The measuring thread:
  // Releases the frame of the last call and waits for the next one. Returns nothing after `timeout`.
  // Fails: the queue has ended and is empty.
  [[nodiscard]] tl::expected<std::optional<LiveFrame>, SourceEnd> take(std::chrono::milliseconds timeout);

  // Returns the number of frames lost because the queue was full. Any thread.
  [[nodiscard]] long lost() const { return lost_; }

 private:
  // Pixels of one frame, owned.
  struct Buffer {
    LiveFrame frame;
    std::vector<std::uint8_t> bytes;
    std::vector<std::uint16_t> words;
    std::vector<std::uint8_t> blocks;
    void copy(const LiveFrame& from);
  };
  [[nodiscard]] std::unique_ptr<Buffer> free_buffer();
  void queue(std::unique_ptr<Buffer> buffer, const LiveFrame& frame);

  std::mutex mutex_;
  std::condition_variable_any filled_, freed_;
  std::vector<std::unique_ptr<Buffer>> free_;
  std::deque<std::unique_ptr<Buffer>> waiting_;
  std::unique_ptr<Buffer> taken_;  // measuring thread only
  std::optional<SourceEnd> end_;
  std::atomic<long> lost_ = 0;
};

}  // namespace moiregauge::internal
