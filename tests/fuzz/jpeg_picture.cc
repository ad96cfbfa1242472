// SPDX-License-Identifier: Apache-2.0
// Input: any bytes as a JPEG file, and as its Exif block.
// Requires: a valid orientation, and a readable image or an error message.
#include "moiregauge/io/pictures/jpeg_reader.h"

#include <algorithm>

#include "moiregauge/io/pictures/exif_orientation.h"
#include "tests/fuzz/picture_trial.h"

namespace {

// Returns the largest number of pixels stated by a frame header anywhere in these bytes.
std::uint64_t promised_pixels(moiregauge::internal::fuzz::Bytes jpeg) {
  std::uint64_t most = 0;
  for (std::size_t at = 0; at + 9 < jpeg.size(); ++at) {
    if (jpeg[at] != 0xff || (jpeg[at + 1] & 0xf0U) != 0xc0U) continue;
    const auto number = [&](std::size_t k) { return std::uint64_t{jpeg[at + k]} << 8U | jpeg[at + k + 1]; };
    most = std::max(most, number(5) * number(7));
  }
  return most;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace moiregauge::internal;
  const fuzz::Bytes bytes(data, size);
  const int orientation = exif_orientation(bytes);
  fuzz::demand(orientation >= 0 && orientation <= 0xffff && rotation_of_orientation(orientation).value_or(0) % 90 == 0);
  if (promised_pixels(bytes) > fuzz::kMaxTrialPixels) return 0;
  const fuzz::InputFile file(bytes);
  fuzz::look_at(read_jpeg(file.path()));
  return 0;
}
