// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/folder/upload_folder.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <span>
#include <system_error>

#include <fmt/format.h>

#include "moiregauge/base/sha256.h"
#include "moiregauge/server/folder/entries.h"

namespace moiregauge::internal {
namespace {

using UploadFailed = tl::unexpected<UploadFailure>;

UploadFailed upload_failure(int status, std::string message) {
  return UploadFailed(UploadFailure{status, std::move(message)});
}

UploadFailed write_failure(std::string_view name) {
  return upload_failure(507, fmt::format("the file could not be stored ({}): {}: free space",
                                         std::generic_category().message(errno), name));
}

// Distinguishes files of one name by their size, so that a changed file does not continue an old one.
std::string part_name(std::string_view name, std::int64_t size) {
  constexpr std::size_t kDigits = 32;
  Sha256 hash;
  const std::string text = fmt::format("{}\n{}", name, size);
  hash.add(std::as_bytes(std::span(text.data(), text.size())));
  return ".moiregauge-part-" + hash.hex().substr(0, kDigits);
}

bool write_whole(int file, std::string_view bytes, std::int64_t offset) {
  while (!bytes.empty()) {
    const ssize_t put = ::pwrite(file, bytes.data(), bytes.size(), offset);
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(put));
    offset += put;
  }
  return true;
}

std::int64_t file_size(int file) {
  struct stat facts {};
  return ::fstat(file, &facts) == 0 ? facts.st_size : 0;
}

OwnedFile open_part(const std::string& path, int flags) {
  constexpr mode_t kPrivate = 0600;
  return OwnedFile(::open(path.c_str(), flags | O_NOFOLLOW | O_CLOEXEC, kPrivate));
}

}  // namespace

bool is_upload_name(std::string_view name) {
  constexpr std::array<std::string_view, 7> kOthers = {".csv", ".txt", ".tsv", ".toml", ".yaml", ".yml", ".uff"};
  if (!is_relative_path(name) || std::ranges::count(name, '/') > 1) return false;
  return has_video_extension(name) || has_image_extension(name) ||
         std::ranges::any_of(kOthers, [name](std::string_view end) { return name.ends_with(end); });
}

tl::expected<std::string, UploadFailure> UploadFolder::part_path(std::string_view name, std::int64_t size) const {
  if (std::ranges::count(name, '/') > 1)
    return upload_failure(422, fmt::format("a folder in a folder is not received: {}: drop the inner folder", name));
  if (!is_upload_name(name))
    return upload_failure(422, "the name is not that of a clip, image or table: the upload: rename the file");
  const std::string_view parent = folder_part(name);
  if (!parent.empty() && !folder_.creatable(parent))
    return upload_failure(422, "the folder of the name is not usable: the upload: rename it");
  struct stat facts {};
  if (::lstat((folder_.root() + "/" + std::string(name)).c_str(), &facts) == 0)
    return upload_failure(409, fmt::format("a file of this name exists: {}: rename one of them", name));
  return folder_.root() + "/" + part_name(name, size);
}

tl::expected<std::int64_t, UploadFailure> UploadFolder::received(std::string_view name, std::int64_t size) {
  const std::lock_guard lock(mutex_);
  return part_path(name, size).map([](const std::string& part) {
    const OwnedFile file = open_part(part, O_RDONLY);
    return file.get() < 0 ? std::int64_t{0} : file_size(file.get());
  });
}

// Creates the folder of the name if necessary, and gives the file its name.
tl::expected<void, UploadFailure> UploadFolder::publish(const std::string& part, std::string_view name) const {
  constexpr mode_t kUsual = 0644, kFolder = 0755;
  const std::string_view parent = folder_part(name);
  const std::string folder = folder_.root() + "/" + std::string(parent);
  if (!parent.empty() && ::mkdir(folder.c_str(), kFolder) != 0 && errno != EEXIST) return write_failure(name);
  const auto target = folder_.creatable(name);
  if (!target) return upload_failure(422, "the folder of the name is not usable: the upload: rename it");
  ::chmod(part.c_str(), kUsual);
  if (::renameat2(AT_FDCWD, part.c_str(), AT_FDCWD, target->c_str(), RENAME_NOREPLACE) == 0) return {};
  if (errno == EEXIST)
    return upload_failure(409, fmt::format("a file of this name exists: {}: rename one of them", name));
  return write_failure(name);
}

tl::expected<std::int64_t, UploadFailure> UploadFolder::add(std::string_view name, std::int64_t offset,
                                                            std::int64_t size, std::string_view bytes) {
  const std::lock_guard lock(mutex_);
  const auto part = part_path(name, size);
  if (!part) return UploadFailed(part.error());
  const OwnedFile file = open_part(*part, O_RDWR | O_CREAT);
  if (file.get() < 0) return write_failure(name);
  const std::int64_t before = file_size(file.get());
  const auto length = static_cast<std::int64_t>(bytes.size());
  if (offset != before)
    return upload_failure(409, fmt::format("{} bytes have arrived, not {}: {}: continue there", before, offset, name));
  if (length > size - offset)
    return upload_failure(400, fmt::format("there are more bytes than stated: {}: start again", name));
  if (!write_whole(file.get(), bytes, offset)) {
    const int why = errno;
    (void)!::ftruncate(file.get(), before);
    errno = why;
    return write_failure(name);
  }
  if (offset + length < size) return offset + length;
  if (::fsync(file.get()) != 0) return write_failure(name);
  return publish(*part, name).map([size] { return size; });
}

}  // namespace moiregauge::internal
