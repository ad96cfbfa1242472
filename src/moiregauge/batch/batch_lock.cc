// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/batch/batch_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

#include <fmt/format.h>

namespace moiregauge::internal {

tl::expected<BatchLock, OutputError> BatchLock::take(const BatchFolder& folder) {
  namespace fs = std::filesystem;
  const std::string shown = folder.path.string();
  const auto unwritable = [&](const std::string& why) {
    return tl::unexpected(
        OutputError{false, fmt::format("the folder cannot be written: {} ({}): choose another with -o", shown, why)});
  };
  std::error_code error;
  if (fs::exists(folder.path, error) && !fs::exists(folder.own(), error)) {
    const bool is_free = fs::is_directory(folder.path, error) && fs::is_empty(folder.path, error);
    if (!is_free)
      return tl::unexpected(OutputError{
          true, fmt::format("the output folder holds other files: {}: choose a new folder with -o", shown)});
  }
  for (const fs::path& each : {folder.states(), folder.slurm()}) {
    fs::create_directories(each, error);
    if (error) return unwritable(error.message());
  }
  const int file = ::open(folder.lock().c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (file < 0) return unwritable(std::strerror(errno));
  if (::flock(file, LOCK_EX | LOCK_NB) != 0) {
    const bool is_taken = errno == EWOULDBLOCK;
    const std::string why = std::strerror(errno);
    ::close(file);
    if (!is_taken) return unwritable(why);
    return tl::unexpected(OutputError{
        true, fmt::format("another batch is working in the output folder: {}: wait for it, or choose another with -o",
                          shown)});
  }
  return BatchLock(file);
}

BatchLock::~BatchLock() {
  if (file_ >= 0) ::close(file_);
}

}  // namespace moiregauge::internal
