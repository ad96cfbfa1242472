// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <system_error>

namespace moiregauge::internal::cli {

// Returns an error if results may not be written into the folder. A folder with the file `mark` is from an earlier
// run of the command and may be replaced. Any other folder that is not empty is not changed.
[[nodiscard]] inline bool is_free(const std::filesystem::path& output, const char* mark) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  return !fs::exists(output, ignored) || (fs::is_directory(output, ignored) && fs::is_empty(output, ignored)) ||
         fs::exists(output / mark, ignored);
}

}  // namespace moiregauge::internal::cli
