// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/journal/journal_file.h"

#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <utility>

namespace moiregauge::internal {
namespace {

using Clock = std::chrono::steady_clock;
// Intervals of writing and syncing: what a kill or a power cut may lose (chosen).
constexpr std::chrono::milliseconds kWriteEvery{100};
constexpr std::chrono::milliseconds kSyncEvery{500};

}  // namespace

JournalFile::JournalFile(int file, std::size_t size, long frames)
    : file_(file), size_(size), synced_size_(size), frames_(frames), safe_frames_(frames) {}

void JournalFile::start() {
  thread_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
}

void JournalFile::add(Bytes record, bool is_frame) {
  const std::lock_guard lock(mutex_);
  added_.push_back({std::move(record), is_frame});
}

void JournalFile::work(const std::stop_token& stop) {
  Clock::time_point synced = Clock::now();
  bool is_last = false;
  while (!is_last && is_good_) {
    std::vector<Record> records;
    {
      std::unique_lock lock(mutex_);
      wake_.wait_for(lock, stop, kWriteEvery, [] { return false; });
      is_last = stop.stop_requested();  // no record is added later
      records.swap(added_);
    }
    if (!write(records)) return;
    if (!is_last && Clock::now() - synced < kSyncEvery) continue;
    if (!sync()) return;
    synced = Clock::now();
  }
}

bool JournalFile::write(const std::vector<Record>& records) {
  for (const Record& record : records) {
    const std::string bytes = record.bytes();
    if (!put(bytes)) return false;
    size_ += bytes.size();
    if (record.is_frame) ++frames_;
  }
  return true;
}

bool JournalFile::put(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t done = ::write(file_, bytes.data(), bytes.size());
    if (done > 0)
      bytes.remove_prefix(static_cast<std::size_t>(done));
    else if (done == 0 || errno != EINTR) {
      fail(done == 0 ? EIO : errno);
      return false;
    }
  }
  return true;
}

bool JournalFile::sync() {
  if (synced_size_ == size_) return true;
  if (::fdatasync(file_) == 0) {
    synced_size_ = size_;
    safe_frames_ = frames_;
    return true;
  }
  sync_failed_ = true;
  fail(errno);
  return false;
}

// Cuts off a partial record. Frames are safe only once they are synced, because the system may discard data after a
// failed sync.
void JournalFile::fail(int why) {
  why_ = std::strerror(why);
  if (::ftruncate(file_, static_cast<off_t>(size_)) == 0 && ::fdatasync(file_) == 0 && !sync_failed_)
    safe_frames_ = frames_;
  is_good_ = false;
}

tl::expected<void, std::string> JournalFile::finish() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
  if (!why_.empty()) return tl::unexpected(why_);
  return {};
}

tl::expected<void, std::string> JournalFile::append(std::string_view bytes) {
  if (why_.empty() && put(bytes)) {
    if (::fdatasync(file_) == 0)
      size_ += bytes.size();
    else
      fail(errno);
    synced_size_ = size_;
  }
  if (!why_.empty()) return tl::unexpected(why_);
  return {};
}

}  // namespace moiregauge::internal
