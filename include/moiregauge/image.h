// SPDX-License-Identifier: Apache-2.0
// Borrowed grey images. Pixel (0, 0) is the centre of the top-left pixel, x is right, y is down.
#pragma once

#include <cstddef>
#include <cstdint>

namespace moiregauge {

// Read-only view of grey pixels that belong to the caller. It never owns memory.
struct ImageView {
  // Views 8-bit pixels. `row_stride`: pixels from one row to the next; 0: the rows are packed.
  ImageView(const std::uint8_t* pixels, int width_px, int height_px, std::ptrdiff_t row_stride = 0)
      : data(pixels), width(width_px), height(height_px), stride(row_stride == 0 ? width_px : row_stride) {}
  // Views pixels of 9 to 16 bits in the low bits of 16-bit words.
  ImageView(const std::uint16_t* pixels, int width_px, int height_px, int grey_bits, std::ptrdiff_t row_stride = 0)
      : data(pixels),
        width(width_px),
        height(height_px),
        stride(row_stride == 0 ? width_px : row_stride),
        bits(grey_bits) {}

  const void* data;       // std::uint8_t for 8 bits, else std::uint16_t
  int width;              // px
  int height;             // px
  std::ptrdiff_t stride;  // pixels from one row to the next
  int bits = 8;           // grey level depth
};

}  // namespace moiregauge
