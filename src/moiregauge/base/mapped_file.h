// SPDX-License-Identifier: Apache-2.0
// Maps a file into memory. The system reads only the pages that the program accesses.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

namespace moiregauge::internal {

// The length is that at opening. If the file is truncated later, its lost pages read as zeros (by a SIGBUS handler,
// which forwards other faults). From then on is_whole() returns false. Check it after each use of the bytes, because a
// result may come from such zeros.
class MappedFile {
 public:
  // Returns null if the file is missing, empty or no plain file, or if 16 files are mapped already. Then read it in
  // another way.
  [[nodiscard]] static std::shared_ptr<const MappedFile> open(const std::string& path);
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  ~MappedFile();

  [[nodiscard]] std::span<const std::byte> bytes() const { return {data_, size_}; }
  [[nodiscard]] bool is_whole() const;
  // Releases the pages of `part` from memory. A later access reads them again.
  void let_go(std::span<const std::byte> part) const;

 private:
  MappedFile() = default;
  int file_ = -1;
  const std::byte* data_ = nullptr;
  std::size_t size_ = 0;
  std::size_t place_ = 0;  // index in the handler's table of mappings
};

}  // namespace moiregauge::internal
