// SPDX-License-Identifier: Apache-2.0
// Reads the text headers of a YUV4MPEG2 stream (yuv4mpeg(5) of mjpegtools, with FFmpeg's additions for grey and deep
// formats).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

#include "moiregauge/image/tone.h"

namespace moiregauge::internal {

struct Y4mHeader {
  int width = 0;     // px
  int height = 0;    // px
  int bits = 8;      // bits per grey level
  double fps = 0.0;  // frames/s; NaN: not stated
  Tone tone;
  bool is_interlaced = false;
  std::size_t luma_bytes = 0;   // per frame
  std::size_t frame_bytes = 0;  // per frame, with chroma and alpha
};

// Largest header line with its line feed, bytes (chosen). FFmpeg writes about 70.
inline constexpr std::size_t kMaxY4mLine = 1024;

// Reads the first line of a stream, without its line feed.
// Fails with "what happened: what to do": another kind of data, an unknown colour space, more than `max_pixels`.
[[nodiscard]] tl::expected<Y4mHeader, std::string> read_y4m_header(std::string_view line, std::int64_t max_pixels);

// Returns true if the line, without its line feed, begins a frame.
[[nodiscard]] bool is_y4m_frame_line(std::string_view line);

}  // namespace moiregauge::internal
