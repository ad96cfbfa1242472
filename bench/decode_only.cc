// SPDX-License-Identifier: Apache-2.0
// Opens a file as `measure` does and decodes all frames, for comparison. Prints the number of frames or bytes.
//
//     decode_only FILE           decodes the frames
//     decode_only --bytes FILE   reads the file's bytes once instead
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <cstdio>
#include <string>

#include "floor_pass.h"
#include "moiregauge/app/open_input.h"

namespace {

int decode(const char* path) {
  const auto source = moiregauge::internal::open_input(path, {});
  if (!source) {
    std::fprintf(stderr, "error: %s\n", source.error().message.c_str());
    return 3;
  }
  long frames = 0;
  while (true) {
    const auto frame = (*source)->next();
    if (!frame) {
      std::fprintf(stderr, "error: %s\n", frame.error().message.c_str());
      return 3;
    }
    if (!*frame) break;
    ++frames;
  }
  std::printf("%ld\n", frames);
  return 0;
}

int pass_over(const char* path) {
  const int file = open(path, O_RDONLY | O_CLOEXEC);
  struct stat about {};
  if (file < 0 || fstat(file, &about) != 0) {
    std::perror(path);
    return 3;
  }
  const auto size = static_cast<std::size_t>(about.st_size);
  void* const bytes = mmap(nullptr, size, PROT_READ, MAP_PRIVATE | MAP_POPULATE, file, 0);
  if (bytes == MAP_FAILED) {
    std::perror(path);
    return 3;
  }
  const auto sum = moiregauge::internal::bench::floor_pass({static_cast<const std::uint8_t*>(bytes), size});
  std::printf("%zu\n", size);
  return sum == 0 ? 3 : 0;  // uses the sum, so that the compiler cannot remove the pass
}

}  // namespace

int main(int argc, char** argv) {
  const bool bytes = argc == 3 && std::string(argv[1]) == "--bytes";
  if (argc != (bytes ? 3 : 2)) {
    std::fprintf(stderr, "usage: decode_only [--bytes] FILE\n");
    return 2;
  }
  return bytes ? pass_over(argv[2]) : decode(argv[1]);
}
