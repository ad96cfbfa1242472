// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace moiregauge::internal {

// SHA-256 over the bytes of all files in order, as hexadecimal digits; a file that cannot be read adds nothing.
// `go_on` is asked after every megabyte; once it says no the answer is empty.
[[nodiscard]] std::string sha256_of_files(
    const std::vector<std::string>& paths, const std::function<bool()>& may_continue = [] { return true; });

// What tells one recording from another at a glance, without reading it all: how many files, how many bytes, and the
// SHA-256 of the first megabyte of the first file and the last megabyte of the last one.
[[nodiscard]] std::string quick_fingerprint(const std::vector<std::string>& paths);

}  // namespace moiregauge::internal
