// SPDX-License-Identifier: Apache-2.0
// The folder that a server shows, and nothing outside it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

namespace moiregauge::internal {

// Descriptor that closes itself. -1: none.
class OwnedFile {
 public:
  explicit OwnedFile(int file = -1) : file_(file) {}
  OwnedFile(const OwnedFile&) = delete;
  OwnedFile& operator=(const OwnedFile&) = delete;
  OwnedFile(OwnedFile&& other) noexcept : file_(other.release()) {}
  OwnedFile& operator=(OwnedFile&& other) noexcept;
  ~OwnedFile();
  [[nodiscard]] int get() const { return file_; }
  [[nodiscard]] int release() {
    const int file = file_;
    file_ = -1;
    return file;
  }

 private:
  int file_;
};

// Returns true for a path of names separated by '/', none of which is empty, hidden, "." or "..". Control characters,
// backslashes and bytes that are not UTF-8 are refused too.
[[nodiscard]] bool is_relative_path(std::string_view path);
// Returns true for one such name of up to 200 bytes.
[[nodiscard]] bool is_plain_name(std::string_view name);

class ConfinedFolder {
 public:
  // Fails with the system's reason.
  [[nodiscard]] static tl::expected<ConfinedFolder, std::string> open(const std::string& path);

  // Returns the folder's absolute path, links resolved.
  [[nodiscard]] const std::string& root() const { return root_; }
  // Opens what a relative path names. The kernel refuses each link that leads outside the folder (openat2). `flags`:
  // those of open(2). Fails (nothing): no such file, or it is outside.
  [[nodiscard]] std::optional<OwnedFile> open_file(std::string_view path, int flags) const;
  // Returns the absolute path of something that exists inside the folder, for readers that take a path.
  [[nodiscard]] std::optional<std::string> existing(std::string_view path) const;
  // Returns the absolute path of something whose folder exists inside this one. It may not exist itself.
  [[nodiscard]] std::optional<std::string> creatable(std::string_view path) const;

 private:
  ConfinedFolder(std::string root, OwnedFile folder) : root_(std::move(root)), folder_(std::move(folder)) {}
  std::string root_;
  OwnedFile folder_;
};

// Returns the part of a path before its last '/', or an empty text.
[[nodiscard]] std::string_view folder_part(std::string_view path);

}  // namespace moiregauge::internal
