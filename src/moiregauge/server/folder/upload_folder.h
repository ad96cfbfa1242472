// SPDX-License-Identifier: Apache-2.0
// Files that arrive in pieces. A file appears in the folder when it is complete.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

#include "moiregauge/server/folder/confined_folder.h"

namespace moiregauge::internal {

struct UploadFailure {
  int status = 400;     // HTTP status
  std::string message;  // "what: where: what to do"
};

// Returns true for a name that may be received: videos, images, tables, site and camera files. At most one folder
// precedes it.
[[nodiscard]] bool is_upload_name(std::string_view name);

class UploadFolder {
 public:
  explicit UploadFolder(const ConfinedFolder& folder) : folder_(folder) {}
  // Returns the number of bytes that have arrived of a file of `size` bytes, also after the server was started again.
  [[nodiscard]] tl::expected<std::int64_t, UploadFailure> received(std::string_view name, std::int64_t size);
  // Adds bytes. `offset` must be the number of bytes received so far. Returns the new number. With the last byte the
  // file appears under its name. It never replaces another file.
  [[nodiscard]] tl::expected<std::int64_t, UploadFailure> add(std::string_view name, std::int64_t offset,
                                                              std::int64_t size, std::string_view bytes);

 private:
  [[nodiscard]] tl::expected<std::string, UploadFailure> part_path(std::string_view name, std::int64_t size) const;
  [[nodiscard]] tl::expected<void, UploadFailure> publish(const std::string& part, std::string_view name) const;

  const ConfinedFolder& folder_;
  std::mutex mutex_;
};

}  // namespace moiregauge::internal
