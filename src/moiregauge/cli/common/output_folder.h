// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <system_error>

namespace moiregauge::internal::cli {

// Whether results may be put into the folder. The file `mark`, which every earlier run of the command left, says that a
// folder is ours to replace; any other folder with something in it is not ours to touch.
[[nodiscard]] inline bool is_free(const std::filesystem::path& output, const char* mark) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  return !fs::exists(output, ignored) || (fs::is_directory(output, ignored) && fs::is_empty(output, ignored)) ||
         fs::exists(output / mark, ignored);
}

}  // namespace moiregauge::internal::cli
