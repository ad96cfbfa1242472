// SPDX-License-Identifier: Apache-2.0
// Completion for shells, made from the tree of options: a new option completes without anything being told of it.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace moiregauge::internal::cli {

// What may stand for an option's value, told by its type name: FILE, DIR, or the words of "on|off|auto".
struct ValueWords {
  bool files = false;
  bool folders = false;
  std::vector<std::string> words;
};
[[nodiscard]] ValueWords value_words(const CLI::Option& option);

[[nodiscard]] std::string bash_completion(const CLI::App& app);
[[nodiscard]] std::string zsh_completion(const CLI::App& app);

}  // namespace moiregauge::internal::cli
