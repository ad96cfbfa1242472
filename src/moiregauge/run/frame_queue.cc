// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/run/frame_queue.h"

#include <algorithm>
#include <utility>

namespace moiregauge::internal {
namespace {

template <typename Grey>
ImageView<Grey> copied(const ImageView<Grey>& from, std::vector<Grey>& into) {
  const auto width = static_cast<std::size_t>(from.width);
  into.resize(width * static_cast<std::size_t>(from.height));
  for (int y = 0; y < from.height; ++y)
    std::ranges::copy(from.row(y), into.begin() + static_cast<std::ptrdiff_t>(width) * y);
  return {into.data(), from.width, from.height, from.width};
}

}  // namespace

void FrameQueue::Buffer::copy(const LiveFrame& from) {
  frame = from;
  if (const auto* grey = std::get_if<ImageView<std::uint8_t>>(&from.frame.luma))
    frame.frame.luma = copied(*grey, bytes);
  else
    frame.frame.luma = copied(std::get<ImageView<std::uint16_t>>(from.frame.luma), words);
  frame.frame.quantiser.blocks = copied(from.frame.quantiser.blocks, blocks);
}

FrameQueue::FrameQueue(int capacity) {
  for (int n = 0; n < capacity + 1; ++n) free_.push_back(std::make_unique<Buffer>());
}

std::unique_ptr<FrameQueue::Buffer> FrameQueue::free_buffer() {
  auto buffer = std::move(free_.back());
  free_.pop_back();
  return buffer;
}

// The lock is not held while pixels are copied.
void FrameQueue::queue(std::unique_ptr<Buffer> buffer, const LiveFrame& frame) {
  buffer->copy(frame);
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(buffer));
  }
  filled_.notify_one();
}

bool FrameQueue::put(const LiveFrame& frame) {
  std::unique_ptr<Buffer> buffer;
  {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) {
      ++lost_;
      return false;
    }
    buffer = free_buffer();
  }
  queue(std::move(buffer), frame);
  return true;
}

bool FrameQueue::put_waiting(const LiveFrame& frame, const std::stop_token& stop) {
  std::unique_ptr<Buffer> buffer;
  {
    std::unique_lock lock(mutex_);
    if (!freed_.wait(lock, stop, [this] { return !free_.empty(); })) return false;
    buffer = free_buffer();
  }
  queue(std::move(buffer), frame);
  return true;
}

void FrameQueue::end(SourceEnd end) {
  {
    const std::lock_guard lock(mutex_);
    end_ = std::move(end);
  }
  filled_.notify_one();
}

tl::expected<std::optional<LiveFrame>, SourceEnd> FrameQueue::take(std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  if (taken_) {
    free_.push_back(std::move(taken_));
    freed_.notify_one();
  }
  filled_.wait_for(lock, timeout, [this] { return !waiting_.empty() || end_; });
  if (waiting_.empty()) {
    if (end_) return tl::unexpected(*end_);
    return std::nullopt;
  }
  taken_ = std::move(waiting_.front());
  waiting_.pop_front();
  LiveFrame frame = taken_->frame;
  frame.queued = static_cast<int>(waiting_.size());
  return frame;
}

}  // namespace moiregauge::internal
