// SPDX-License-Identifier: Apache-2.0
// Input: any bytes as an uncompressed AVI or Matroska file.
// Requires: all stated pixels are inside the file.
#include "moiregauge/decoder/stored/stored_video.h"

#include "tests/fuzz/input_file.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace moiregauge::internal;
  const auto video = stored_video(std::as_bytes(fuzz::Bytes(data, size)));
  if (!video) return 0;
  fuzz::demand(video->width > 0 && video->height > 0 && video->bits >= 8 && video->bits <= 16);
  fuzz::demand(video->ticks.size() == video->frames.size() && video->tick_numerator > 0 && video->tick_denominator > 0);
  const std::size_t row = static_cast<std::size_t>(video->width) * (video->bits > 8 ? 2 : 1);
  fuzz::demand(video->row_bytes >= row);
  const std::size_t bytes = video->row_bytes * (static_cast<std::size_t>(video->height) - 1) + row;
  for (const std::size_t begin : video->frames) fuzz::demand(begin <= size && bytes <= size - begin);
  return 0;
}
