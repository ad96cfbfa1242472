// SPDX-License-Identifier: Apache-2.0
// Generates shell completion from the program's options, so that new options need no further code.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace moiregauge::internal::cli {

// Possible values of an option by its type name: FILE, DIR, or the words of "on|off|auto".
struct ValueWords {
  bool files = false;
  bool folders = false;
  std::vector<std::string> words;
};
[[nodiscard]] ValueWords value_words(const CLI::Option& option);

[[nodiscard]] std::string bash_completion(const CLI::App& app);
[[nodiscard]] std::string zsh_completion(const CLI::App& app);

}  // namespace moiregauge::internal::cli
