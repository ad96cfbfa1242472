// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace moiregauge::internal {

// Returns the SHA-256 over the bytes of all files in order, as hexadecimal digits. A file that cannot be read adds no
// bytes.
// Calls `may_continue` after every megabyte. Returns an empty text once it returns false.
[[nodiscard]] std::string sha256_of_files(
    const std::vector<std::string>& paths, const std::function<bool()>& may_continue = [] { return true; });

// Returns a fast fingerprint that distinguishes recordings: number of files, number of bytes, and a SHA-256. The
// SHA-256 covers the first megabyte of the first file and the last megabyte of the last file.
[[nodiscard]] std::string quick_fingerprint(const std::vector<std::string>& paths);

}  // namespace moiregauge::internal
