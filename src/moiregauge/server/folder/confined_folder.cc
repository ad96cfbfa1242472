// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/folder/confined_folder.h"

#include <fcntl.h>
#include <linux/openat2.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <system_error>
#include <utility>

#include "moiregauge/base/control_characters.h"

namespace moiregauge::internal {
namespace {

constexpr std::size_t kMaxPath = 1024, kMaxName = 200;  // bytes

// Opens below a folder. Links may lead anywhere inside it, but not outside.
int open_beneath(int folder, const std::string& path, int flags) {
  open_how how{};
  // Opening a FIFO would wait. openat2 refuses flags that O_PATH ignores.
  how.flags = static_cast<std::uint64_t>(flags | O_CLOEXEC | ((flags & O_PATH) != 0 ? 0 : O_NONBLOCK));
  how.resolve = RESOLVE_BENEATH | RESOLVE_NO_MAGICLINKS;
  return static_cast<int>(::syscall(SYS_openat2, folder, path.c_str(), &how, sizeof how));
}

// For kernels before 5.6 and containers that hide openat2. It refuses every link.
int open_without_links(int folder, const std::string& path, int flags) {
  OwnedFile at(::dup(folder));
  std::size_t begin = 0;
  while (true) {
    const std::size_t end = std::min(path.find('/', begin), path.size());
    const bool is_last = end == path.size();
    const std::string name = path.substr(begin, end - begin);
    const int how =
        is_last ? flags | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK : O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC;
    OwnedFile next(::openat(at.get(), name.c_str(), how));
    if (next.get() < 0 || is_last) return next.release();
    at = std::move(next);
    begin = end + 1;
  }
}

bool is_link(int file) {
  struct stat facts {};
  return ::fstat(file, &facts) == 0 && S_ISLNK(facts.st_mode);
}

}  // namespace

OwnedFile& OwnedFile::operator=(OwnedFile&& other) noexcept {
  std::swap(file_, other.file_);
  return *this;
}

OwnedFile::~OwnedFile() {
  if (file_ >= 0) ::close(file_);
}

bool is_plain_name(std::string_view name) {
  return !name.empty() && name.size() <= kMaxName && name.front() != '.' &&
         name.find_first_of("/\\") == std::string_view::npos && !has_control_character(name);
}

bool is_relative_path(std::string_view path) {
  if (path.empty() || path.size() > kMaxPath) return false;
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('/', begin), path.size());
    if (!is_plain_name(path.substr(begin, end - begin))) return false;
    begin = end + 1;
  }
  return true;
}

std::string_view folder_part(std::string_view path) {
  const auto slash = path.rfind('/');
  return slash == std::string_view::npos ? std::string_view{} : path.substr(0, slash);
}

tl::expected<ConfinedFolder, std::string> ConfinedFolder::open(const std::string& path) {
  const std::unique_ptr<char, decltype(&std::free)> real(::realpath(path.c_str(), nullptr), &std::free);
  if (!real) return tl::unexpected(std::generic_category().message(errno));
  OwnedFile folder(::open(real.get(), O_PATH | O_DIRECTORY | O_CLOEXEC));
  if (folder.get() < 0) return tl::unexpected(std::generic_category().message(errno));
  return ConfinedFolder(real.get(), std::move(folder));
}

std::optional<OwnedFile> ConfinedFolder::open_file(std::string_view path, int flags) const {
  if (!is_relative_path(path)) return std::nullopt;
  const std::string name(path);
  int file = open_beneath(folder_.get(), name, flags);
  if (file < 0 && (errno == ENOSYS || errno == EPERM)) file = open_without_links(folder_.get(), name, flags);
  if (file < 0) return std::nullopt;
  OwnedFile opened(file);
  if (is_link(file)) return std::nullopt;
  return opened;
}

std::optional<std::string> ConfinedFolder::existing(std::string_view path) const {
  if (!open_file(path, O_PATH)) return std::nullopt;
  return root_ + "/" + std::string(path);
}

std::optional<std::string> ConfinedFolder::creatable(std::string_view path) const {
  if (!is_relative_path(path)) return std::nullopt;
  const std::string_view parent = folder_part(path);
  if (!parent.empty() && !open_file(parent, O_PATH | O_DIRECTORY)) return std::nullopt;
  // Something that exists, such as a link, must be inside too.
  struct stat facts {};
  const std::string full = root_ + "/" + std::string(path);
  if (::lstat(full.c_str(), &facts) == 0 && !open_file(path, O_PATH)) return std::nullopt;
  return full;
}

}  // namespace moiregauge::internal
