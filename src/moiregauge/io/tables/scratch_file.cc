// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/tables/scratch_file.h"

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <system_error>

namespace moiregauge::internal {

ScratchFile::ScratchFile() {
  std::error_code error;
  std::string name = (std::filesystem::temp_directory_path(error) / "moiregauge-XXXXXX").string();
  if (error || ::mkdtemp(name.data()) == nullptr) return;
  folder_ = name;
  path_ = (folder_ / "table").string();
}

ScratchFile::~ScratchFile() {
  std::error_code ignored;
  if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
}

std::string ScratchFile::bytes() const {
  std::ifstream file(path_, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

}  // namespace moiregauge::internal
