// SPDX-License-Identifier: Apache-2.0
// A drawn recording as the file of the study states it.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "studies/world/space.h"

namespace world {

// The file: one key and its words per line. Lines that begin with # are comments.
class DrawFile {
 public:
  explicit DrawFile(const std::string& path);  // throws std::runtime_error
  [[nodiscard]] const std::vector<std::string>& words(const std::string& key) const;
  [[nodiscard]] std::vector<double> numbers(const std::string& key, std::size_t count) const;
  [[nodiscard]] double number(const std::string& key) const { return numbers(key, 1)[0]; }
  [[nodiscard]] Track track(const std::string& key) const;  // a missing track is 0
  [[nodiscard]] bool has(const std::string& key) const { return words_.contains(key); }
  [[nodiscard]] const std::vector<std::string>& sheets() const { return sheets_; }

 private:
  std::map<std::string, std::vector<std::string>> words_;
  std::vector<std::string> sheets_;
};

}  // namespace world
