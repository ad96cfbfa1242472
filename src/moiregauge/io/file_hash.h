// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace moiregauge {

// SHA-256 over the bytes of all files in order, as hexadecimal digits; a file that cannot be read adds nothing.
[[nodiscard]] std::string sha256_of_files(const std::vector<std::string>& paths);

}  // namespace moiregauge
