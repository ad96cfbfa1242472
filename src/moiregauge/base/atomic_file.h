// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include <tl/expected.hpp>

namespace moiregauge::internal {

// Writes a file completely or not at all: temporary name next to it, fsync, rename, fsync of the folder.
// Fails with the path and the reason, and removes the temporary file.
// If only the fsync of the folder fails, the new file exists, but a power cut can still lose it.
[[nodiscard]] tl::expected<void, std::string> write_file_atomically(const std::string& path, std::string_view bytes);

[[nodiscard]] bool sync_file(const std::string& path);

// Writes the names in a folder to the disk. Returns false and sets errno on failure. A file system that cannot sync a
// folder is no failure.
[[nodiscard]] bool sync_folder(const std::string& folder);

}  // namespace moiregauge::internal
