// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include <tl/expected.hpp>

namespace moiregauge {

// Writes the whole file or leaves what was there: a temporary name beside it, fsync, rename, fsync of the folder.
// An error reads "path: cannot be written: why"; the temporary file is gone then.
[[nodiscard]] tl::expected<void, std::string> write_file_atomically(const std::string& path, std::string_view bytes);

}  // namespace moiregauge
