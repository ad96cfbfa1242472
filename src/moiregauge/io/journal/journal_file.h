// SPDX-License-Identifier: Apache-2.0
// A file that grows by whole records and is brought to the disk about twice a second, by a thread of its own: nobody
// who adds to it waits for a disk.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <tl/expected.hpp>

namespace moiregauge::internal {

// What a kill costs is what was added in the last tenth of a second; a power cut costs what was added since the last
// sync but one ended: 0.6 s, and as long as the disk takes for one.
class JournalFile {
 public:
  // `file` is open for writing; its good part ends at `size` and holds `frames` frames. It stays the caller's.
  JournalFile(int file, std::size_t size, long frames);
  JournalFile(const JournalFile&) = delete;
  JournalFile& operator=(const JournalFile&) = delete;
  ~JournalFile() = default;  // writes what was added

  // Before start() and after finish(): one record that is no frame, on the disk when it returns. Fails with the
  // system's words, as finish() does.
  [[nodiscard]] tl::expected<void, std::string> append(std::string_view bytes);
  void start();
  // Ends the thread: all that was added is on the disk.
  [[nodiscard]] tl::expected<void, std::string> finish();

  using Bytes = std::function<std::string()>;
  // Bytes are made by the thread, so what they are made of must be theirs.
  void add(Bytes record, bool is_frame);
  // False from the first failure on; nothing is written then, and what was written in part is cut off.
  [[nodiscard]] bool good() const { return is_good_; }
  // While the thread does not run: how many frames a run that goes on will find.
  [[nodiscard]] long frames_safe() const { return safe_frames_; }

 private:
  struct Record {
    Bytes bytes;
    bool is_frame;
  };
  void work(const std::stop_token& stop);
  bool write(const std::vector<Record>& records);
  bool put(std::string_view bytes);
  bool sync();
  void fail(int why);

  const int file_;
  // Of the thread, until it is joined.
  std::size_t size_;
  std::size_t synced_size_;
  long frames_;
  long safe_frames_;
  bool sync_failed_ = false;
  std::string why_;
  // Of both.
  std::atomic<bool> is_good_ = true;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::vector<Record> added_;
  std::jthread thread_;  // last: it uses all of the above
};

}  // namespace moiregauge::internal
