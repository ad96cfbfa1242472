// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/base/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>

namespace moiregauge::internal {
namespace {

bool write_all(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

// mkostemp creates private files (mode 0600). Results get the mode of any other new file.
bool open_up(int file) {
  const mode_t mask = ::umask(0);
  ::umask(mask);
  return ::fchmod(file, 0666 & ~mask) == 0;
}

}  // namespace

bool sync_file(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return false;
  const bool synced = ::fsync(file) == 0;
  const int why = errno;
  ::close(file);
  errno = why;
  return synced;
}

bool sync_folder(const std::string& folder) {
  const int file = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return errno == EACCES;  // write access without read access cannot be synced
  const bool synced = ::fsync(file) == 0 || errno == EINVAL || errno == ENOTSUP;
  const int why = errno;
  ::close(file);
  errno = why;
  return synced;
}

tl::expected<void, std::string> write_file_atomically(const std::string& path, std::string_view bytes) {
  std::string unfinished = path + ".XXXXXX";
  const auto failed = [&](int why) { return tl::unexpected(fmt::format("{} ({})", path, std::strerror(why))); };
  const int file = ::mkostemp(unfinished.data(), O_CLOEXEC);
  if (file < 0) return failed(errno);
  bool wrote = write_all(file, bytes) && open_up(file) && ::fsync(file) == 0;
  int why = errno;
  if (::close(file) != 0 && wrote) {
    wrote = false;
    why = errno;
  }
  if (wrote && std::rename(unfinished.c_str(), path.c_str()) != 0) {
    wrote = false;
    why = errno;
  }
  if (!wrote) {
    ::unlink(unfinished.c_str());
    return failed(why);
  }
  if (!sync_folder(std::filesystem::path(path).parent_path().string())) return failed(errno);
  return {};
}

}  // namespace moiregauge::internal
