// SPDX-License-Identifier: Apache-2.0
// Input: any bytes as a PNG file. The check sums are corrected first, because nearly all trials would stop at a wrong
// one. Requires: a readable image or an error message.
#include <string_view>
#include <vector>

#include "moiregauge/base/crc32.h"
#include "moiregauge/io/pictures/png_reader.h"
#include "tests/fuzz/picture_trial.h"

namespace {

constexpr std::size_t kSignature = 8, kChunkHead = 8;  // bytes; a chunk is length, name, data, check sum

std::uint32_t number_at(const std::vector<std::uint8_t>& png, std::size_t at) {
  return std::uint32_t{png[at]} << 24U | std::uint32_t{png[at + 1]} << 16U | std::uint32_t{png[at + 2]} << 8U |
         png[at + 3];
}

void sign_chunks(std::vector<std::uint8_t>& png) {
  for (std::size_t at = kSignature; at + kChunkHead + 4 <= png.size();) {
    const std::size_t length = number_at(png, at);
    if (length > png.size() - at - kChunkHead - 4) return;
    const std::size_t end = at + kChunkHead + length;
    const auto sum = moiregauge::internal::crc32({reinterpret_cast<const char*>(png.data()) + at + 4, length + 4});
    for (std::size_t k = 0; k < 4; ++k) png[end + k] = static_cast<std::uint8_t>(sum >> (24 - 8 * k));
    at = end + 4;
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace moiregauge::internal;
  std::vector<std::uint8_t> png(data, data + size);
  if (size >= 24 && std::uint64_t{number_at(png, 16)} * number_at(png, 20) > fuzz::kMaxTrialPixels) return 0;
  sign_chunks(png);
  const fuzz::InputFile file(png);
  fuzz::look_at(read_png(file.path()));
  return 0;
}
