// SPDX-License-Identifier: Apache-2.0
// Input: any text as the first line of a YUV4MPEG2 stream.
// Requires: an accepted frame has at most the allowed pixels, and its luma is a part of the frame. A refusal has two
// parts without a line end.
#include "moiregauge/camera/pipe/y4m_header.h"

#include "tests/fuzz/input_file.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace moiregauge::internal;
  const std::string text = fuzz::text_of({data, size});
  constexpr std::int64_t kMaxPixels = 64'000'000;
  static_cast<void>(is_y4m_frame_line(text));
  const auto header = read_y4m_header(text, kMaxPixels);
  if (!header) {
    fuzz::demand(header.error().find(": ") != std::string::npos);
    return 0;
  }
  const auto pixels = static_cast<std::size_t>(header->width) * static_cast<std::size_t>(header->height);
  fuzz::demand(header->width > 0 && header->height > 0 && pixels <= static_cast<std::size_t>(kMaxPixels));
  fuzz::demand(header->bits >= 8 && header->bits <= 16);
  fuzz::demand(header->luma_bytes == pixels * (header->bits > 8 ? 2 : 1));
  fuzz::demand(header->frame_bytes >= header->luma_bytes && header->frame_bytes <= 4 * header->luma_bytes);
  fuzz::demand(!(header->fps <= 0.0));
  return 0;
}
