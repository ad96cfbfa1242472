// SPDX-License-Identifier: Apache-2.0
// Opens plain files for reading. No function here blocks: opening a FIFO without a writer would wait for ever.
#pragma once

#include <cstdio>
#include <memory>
#include <string>

#include <tl/expected.hpp>

namespace moiregauge::internal {

// Returns the kind of what is at a path, e.g. "a FIFO" or "a broken link". Returns an empty text for a plain file.
// Follows links.
[[nodiscard]] std::string kind_unless_plain(const std::string& path);

using OpenedFile = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

// Opens a plain file for reading its bytes. Fails with the reason, e.g. "it is a FIFO" or "Permission denied".
[[nodiscard]] tl::expected<OpenedFile, std::string> open_plain_file(const std::string& path);

}  // namespace moiregauge::internal
