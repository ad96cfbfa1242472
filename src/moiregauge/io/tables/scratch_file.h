// SPDX-License-Identifier: Apache-2.0
// A file name for libraries that cannot write to memory. The file is private, and it is deleted at the end.
#pragma once

#include <filesystem>
#include <string>

namespace moiregauge::internal {

class ScratchFile {
 public:
  ScratchFile();
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  ~ScratchFile();
  // Returns the path. Empty: there is no folder for it.
  [[nodiscard]] const std::string& path() const { return path_; }
  // Returns the content, empty if the library wrote none.
  [[nodiscard]] std::string bytes() const;

 private:
  std::filesystem::path folder_;
  std::string path_;
};

}  // namespace moiregauge::internal
