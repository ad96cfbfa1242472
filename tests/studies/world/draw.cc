// SPDX-License-Identifier: Apache-2.0
#include "studies/world/draw.h"

#include <fstream>
#include <sstream>
#include <stdexcept>

namespace world {

DrawFile::DrawFile(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream in(line);
    std::string key;
    if (!(in >> key) || key[0] == '#') continue;
    std::vector<std::string> words;
    for (std::string word; in >> word;) words.push_back(word);
    if (key == "sheets") sheets_ = words;
    if (!words_.emplace(key, words).second) throw std::runtime_error("stated twice: " + key);
  }
}

const std::vector<std::string>& DrawFile::words(const std::string& key) const {
  const auto found = words_.find(key);
  if (found == words_.end()) throw std::runtime_error("missing: " + key);
  return found->second;
}

std::vector<double> DrawFile::numbers(const std::string& key, std::size_t count) const {
  std::vector<double> out;
  for (const std::string& word : words(key)) out.push_back(std::stod(word));
  if (out.size() != count) throw std::runtime_error("wrong count of numbers: " + key);
  return out;
}

Track DrawFile::track(const std::string& key) const { return has(key) ? Track(words(key)) : Track(); }

}  // namespace world
