// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>

namespace moiregauge::internal {

// Picture that is compressed row by row.
struct JpegRows {
  int width = 0, height = 0;                                       // px
  int components = 1;                                              // bytes per pixel: 1 (grey) or 3 (red, green, blue)
  int quality = 85;                                                // libjpeg's scale, 0 to 100
  bool is_small = false;                                           // takes twice the time for a few per cent of bytes
  std::function<void(int y, std::span<std::uint8_t> bytes)> fill;  // writes row y
};

// Returns the picture as a JPEG file. Returns an empty text if libjpeg fails.
[[nodiscard]] std::string jpeg_bytes(const JpegRows& picture);

}  // namespace moiregauge::internal
