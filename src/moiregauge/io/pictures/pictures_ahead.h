// SPDX-License-Identifier: Apache-2.0
// Reads images ahead in separate threads while earlier ones are measured. They are delivered in order, so results do
// not depend on the number of threads.
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

// Limits the memory to 16 images, whatever the number of threads: 14 being read, one ready, one in use.
inline constexpr int kMaxReaders = 14;

class PicturesAhead {
 public:
  // Reads images `first` to `end - 1`. With more than one reader, several threads call `read` at once.
  PicturesAhead(long first, long end, std::function<PictureOrError(long)> read, int readers);
  PicturesAhead(const PicturesAhead&) = delete;
  PicturesAhead& operator=(const PicturesAhead&) = delete;
  ~PicturesAhead() = default;  // waits for images that are being read

  // Returns the next image once it is read. Rethrows the exception of its reader.
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
  long ahead_;    // largest number of images read but not taken
  long to_read_;  // guarded by mutex_, as all members below
  long to_take_;
  std::map<long, Slot> ready_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::vector<std::jthread> readers_;  // last: joined before the members it uses are destroyed
};

}  // namespace moiregauge::internal
