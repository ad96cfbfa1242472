// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/pictures/pictures_ahead.h"

#include <algorithm>
#include <system_error>
#include <utility>

namespace moiregauge::internal {

PicturesAhead::PicturesAhead(long first, long end, std::function<PictureOrError(long)> read, int readers)
    : read_(std::move(read)), end_(end), to_read_(first), to_take_(first) {
  readers = std::clamp(readers, 1, kMaxReaders);
  ahead_ = readers + 1;  // one image is ready while every reader is busy; more would only cost memory
  try {
    for (int i = 0; i < readers; ++i) readers_.emplace_back([this](const std::stop_token& stop) { work(stop); });
  } catch (const std::system_error&) {  // fewer threads can start; without any, take() reads
  }
}

PicturesAhead::Slot PicturesAhead::slot_of(long number) const {
  try {
    return {read_(number), nullptr};
  } catch (...) {  // e.g. no memory: rethrown in take()
    return {tl::unexpected(InputError{}), std::current_exception()};
  }
}

void PicturesAhead::work(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (true) {
    const bool go = changed_.wait(lock, stop, [this] { return to_read_ < std::min(end_, to_take_ + ahead_); });
    if (!go || stop.stop_requested()) return;
    const long number = to_read_++;
    lock.unlock();
    Slot slot = slot_of(number);
    lock.lock();
    ready_.emplace(number, std::move(slot));
    changed_.notify_all();
  }
}

PictureOrError PicturesAhead::take() {
  if (readers_.empty()) return read_(to_take_++);
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return ready_.contains(to_take_); });
  Slot slot = std::move(ready_.extract(to_take_).mapped());
  ++to_take_;
  lock.unlock();
  changed_.notify_all();
  if (slot.thrown) std::rethrow_exception(slot.thrown);
  return std::move(slot.picture);
}

}  // namespace moiregauge::internal
