// SPDX-License-Identifier: Apache-2.0
// Appends whole records to a file. A separate thread writes and syncs it about twice a second, so that the caller never
// waits for a disk.
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

// A kill loses at most the last 0.1 s. A power cut loses at most the last 0.6 s plus the duration of one sync.
class JournalFile {
 public:
  // `file` is open for writing and remains the caller's. Its valid part has `size` bytes and `frames` frames.
  JournalFile(int file, std::size_t size, long frames);
  JournalFile(const JournalFile&) = delete;
  JournalFile& operator=(const JournalFile&) = delete;
  JournalFile(JournalFile&&) = delete;
  JournalFile& operator=(JournalFile&&) = delete;
  ~JournalFile() = default;  // writes pending records

  // Appends one record that is no frame, and syncs. Call it before start() or after finish(). Fails with the system's
  // message.
  [[nodiscard]] tl::expected<void, std::string> append(std::string_view bytes);
  void start();
  // Ends the thread after all records are synced. Fails with the system's message.
  [[nodiscard]] tl::expected<void, std::string> finish();

  using Bytes = std::function<std::string()>;
  // Adds a record. The thread calls `record` to create the bytes, so `record` must own its data.
  void add(Bytes record, bool is_frame);
  // Returns false after the first failure. Nothing is written from then on, and a partial record is cut off.
  [[nodiscard]] bool good() const { return is_good_; }
  // Returns the number of frames that a resumed run will find. Call it while the thread is not running.
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
  // Used by the thread only, until it is joined.
  std::size_t size_;
  std::size_t synced_size_;
  long frames_;
  long safe_frames_;
  bool sync_failed_ = false;
  std::string why_;
  // Shared by both threads.
  std::atomic<bool> is_good_ = true;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::vector<Record> added_;
  std::jthread thread_;  // last: it uses all members above
};

}  // namespace moiregauge::internal
