// SPDX-License-Identifier: Apache-2.0
// Names of run directories: safe on every file system, unique in a batch, and stable.
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace moiregauge::internal {

// Returns the text as a name of a folder. Letters, digits, `_`, `-`, `+`, `,`, `(`, `)` and other valid UTF-8 stay.
// Every other character becomes `_`, and so does a `-` or `+` at the start. At most 80 bytes. Never empty.
[[nodiscard]] std::string safe_name(std::string_view text);

// Returns the name that a clip has if no other clip has it: its file name without extension. For a folder `frames`
// it is the name of the folder above.
[[nodiscard]] std::string plain_run_name(const std::string& input);

// The names that a batch has given. A clip keeps its name for ever.
class RunNames {
 public:
  void keep(const std::string& input, const std::string& name);
  // Returns the names of the inputs, in their order. A new input whose plain name is taken, or which another new input
  // has too, gets its folder's name as suffix. If that is not enough, it also gets eight digits of its path's SHA-256.
  [[nodiscard]] std::vector<std::string> names_of(const std::vector<std::string>& inputs);

 private:
  void name_by(std::string (*naming)(const std::string&), std::vector<std::string>& unnamed);
  std::map<std::string, std::string> name_of_;
  std::set<std::string> taken_;  // in lower case, because some file systems do not distinguish
};

}  // namespace moiregauge::internal
