// SPDX-License-Identifier: Apache-2.0
// Files that are opened to be read. Nothing here ever waits: a FIFO without a writer would block for ever.
#pragma once

#include <cstdio>
#include <memory>
#include <string>

#include <tl/expected.hpp>

namespace moiregauge::internal {

// Returns what lies at a path that is no plain file, e.g. "a FIFO" or "a link that leads nowhere"; empty for a plain
// file. Links are followed.
[[nodiscard]] std::string kind_unless_plain(const std::string& path);

using OpenedFile = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

// Opens a plain file to read its bytes. Fails with the reason in words, e.g. "it is a FIFO" or "Permission denied".
[[nodiscard]] tl::expected<OpenedFile, std::string> open_plain_file(const std::string& path);

}  // namespace moiregauge::internal
