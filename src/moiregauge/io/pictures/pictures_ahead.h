// SPDX-License-Identifier: Apache-2.0
// Pictures read by threads of their own while the ones before them are measured; handed out in order, so nothing that
// is measured depends on the number of threads.
#pragma once

#include <condition_variable>
#include <exception>
#include <functional>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

#include "moiregauge/io/pictures/picture.h"

namespace moiregauge::internal {

// However many threads there are: with the picture in use never more than 16 in memory.
inline constexpr int kMaxReaders = 14;

class PicturesAhead {
 public:
  // Pictures from `first` up to `end`. With more than one reader `read` is called by several threads at once.
  PicturesAhead(long first, long end, std::function<PictureOrError(long)> read, int readers);
  PicturesAhead(const PicturesAhead&) = delete;
  PicturesAhead& operator=(const PicturesAhead&) = delete;
  ~PicturesAhead() = default;  // waits for the pictures that are being read

  // The next one, as soon as it is read; rethrows what reading it threw.
  [[nodiscard]] PictureOrError take();

 private:
  struct Slot {
    PictureOrError picture;
    std::exception_ptr thrown;
  };
  void work(const std::stop_token& stop);
  [[nodiscard]] Slot slot_of(long number) const;

  std::function<PictureOrError(long)> read_;
  long end_;
  long ahead_;    // how far reading may run before what is taken
  long to_read_;  // guarded by mutex_, as all below
  long to_take_;
  std::map<long, Slot> ready_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::vector<std::jthread> readers_;  // last: joined before anything they use is gone
};

}  // namespace moiregauge::internal
