// SPDX-License-Identifier: Apache-2.0
// A file's bytes as memory: only the pages that are looked at are ever read.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

namespace moiregauge::internal {

// The length is that of the moment of opening. Of a file that is cut short afterwards the pages behind its end cannot
// be read: they turn to zeros under whoever reads them (a handler of SIGBUS, which passes on what is not ours), and
// is_whole() says no from then on. Ask it before each frame; a result made of zeros is followed by the answer no.
class MappedFile {
 public:
  // Null when there is no such file, it is empty, or too many are open (then read it in another way).
  [[nodiscard]] static std::shared_ptr<const MappedFile> open(const std::string& path);
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  ~MappedFile();

  [[nodiscard]] std::span<const std::byte> bytes() const { return {data_, size_}; }
  [[nodiscard]] bool is_whole() const;
  // This part is not needed for now: its pages no longer count as ours. What is looked at again comes back.
  void let_go(std::span<const std::byte> part) const;

 private:
  MappedFile() = default;
  int file_ = -1;
  const std::byte* data_ = nullptr;
  std::size_t size_ = 0;
  std::size_t place_ = 0;  // among the mappings that the handler knows
};

}  // namespace moiregauge::internal
