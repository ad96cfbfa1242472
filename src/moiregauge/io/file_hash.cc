// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/file_hash.h"

#include <cstdio>
#include <memory>

#include "moiregauge/run/sha256.h"

namespace moiregauge {

std::string sha256_of_files(const std::vector<std::string>& paths, const std::function<bool()>& go_on) {
  Sha256 sum;
  std::vector<std::byte> block(std::size_t{1} << 20);
  for (const std::string& path : paths) {
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
    if (!file) continue;
    while (const std::size_t read = std::fread(block.data(), 1, block.size(), file.get())) {
      sum.add({block.data(), read});
      if (!go_on()) return {};
    }
  }
  return sum.hex();
}

}  // namespace moiregauge
