// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace moiregauge {

// SHA-256 over the bytes of all files in order, as hexadecimal digits; a file that cannot be read adds nothing.
// `go_on` is asked after every megabyte; once it says no the answer is empty.
[[nodiscard]] std::string sha256_of_files(
    const std::vector<std::string>& paths, const std::function<bool()>& go_on = [] { return true; });

}  // namespace moiregauge
