// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/base/plain_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>

namespace moiregauge::internal {
namespace {

std::string kind_of_mode(mode_t mode) {
  if (S_ISREG(mode)) return "";
  if (S_ISDIR(mode)) return "a folder";
  if (S_ISFIFO(mode)) return "a FIFO";
  if (S_ISSOCK(mode)) return "a socket";
  return "a device";
}

}  // namespace

std::string kind_unless_plain(const std::string& path) {
  struct stat about {};
  if (::stat(path.c_str(), &about) == 0) return kind_of_mode(about.st_mode);
  if (errno == ELOOP) return "a link to itself";
  std::error_code ignored;
  return std::filesystem::is_symlink(path, ignored) ? "a broken link" : std::strerror(errno);
}

tl::expected<OpenedFile, std::string> open_plain_file(const std::string& path) {
  struct stat about {};
  // Check the kind first, because opening a device may have side effects.
  if (::stat(path.c_str(), &about) != 0) return tl::unexpected(std::string(std::strerror(errno)));
  if (const std::string kind = kind_of_mode(about.st_mode); !kind.empty()) return tl::unexpected("it is " + kind);
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (file < 0) return tl::unexpected(std::string(std::strerror(errno)));
  const bool is_plain = ::fstat(file, &about) == 0 && S_ISREG(about.st_mode);
  OpenedFile opened(is_plain ? ::fdopen(file, "rb") : nullptr, &std::fclose);
  if (!opened) ::close(file);
  if (!opened) return tl::unexpected(std::string("it is not a plain file"));
  return opened;
}

}  // namespace moiregauge::internal
