// SPDX-License-Identifier: Apache-2.0
// Gives the bytes of one trial a file name, for readers that open files.
#pragma once

#include <sys/mman.h>
#include <sys/types.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>

namespace moiregauge::internal::fuzz {

using Bytes = std::span<const std::uint8_t>;

// Aborts if a requirement on the code under test is not met. The sanitizer's stack trace shows the position.
inline void demand(bool kept) {
  if (!kept) std::abort();
}

// File in memory. Each open() of its path starts at the first byte.
class InputFile {
 public:
  explicit InputFile(Bytes bytes) : file_(::memfd_create("input", MFD_CLOEXEC)) {
    demand(file_ >= 0 && ::write(file_, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()));
  }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;
  ~InputFile() { ::close(file_); }
  [[nodiscard]] std::string path() const { return "/proc/self/fd/" + std::to_string(file_); }

 private:
  int file_;
};

inline std::string text_of(Bytes bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

}  // namespace moiregauge::internal::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
