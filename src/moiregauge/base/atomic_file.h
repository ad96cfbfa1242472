// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include <tl/expected.hpp>

namespace moiregauge::internal {

// Writes the whole file or leaves what was there: a temporary name beside it, fsync, rename, fsync of the folder.
// An error reads "path: cannot be written: why"; the temporary file is gone then. (Where the folder's sync fails the
// new file is there, but might be gone after a power cut.)
[[nodiscard]] tl::expected<void, std::string> write_file_atomically(const std::string& path, std::string_view bytes);

[[nodiscard]] bool sync_file(const std::string& path);

// Brings the names in a folder to the disk. False, with errno, where that failed; a file system that cannot do it is no
// failure.
[[nodiscard]] bool sync_folder(const std::string& folder);

}  // namespace moiregauge::internal
