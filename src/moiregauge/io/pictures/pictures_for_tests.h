// SPDX-License-Identifier: Apache-2.0
// Writes small image files for the tests of this module. Uses libpng directly, not the simulator's writer: a mistake
// shared by writer and reader would cancel out.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include <png.h>

#include "moiregauge/base/folder_for_tests.h"

namespace moiregauge::internal {

struct TestPng {
  int width = 4;
  int height = 2;
  int depth = 8;        // bits per sample, 8 or 16
  int significant = 0;  // significant bits; 0: no sBIT chunk
  bool colour = false;
};

// Writes samples row by row, with the values to be stored.
inline void write_test_png(const std::string& path, const TestPng& shape, const std::vector<std::uint16_t>& samples) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  std::FILE* file = std::fopen(path.c_str(), "wb");
  png_init_io(png, file);
  png_set_IHDR(png, info, static_cast<png_uint_32>(shape.width), static_cast<png_uint_32>(shape.height), shape.depth,
               shape.colour ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_color_8 significant{};
  significant.gray = significant.red = significant.green = significant.blue = static_cast<png_byte>(shape.significant);
  if (shape.significant > 0) png_set_sBIT(png, info, &significant);
  png_write_info(png, info);
  std::vector<png_byte> bytes;
  for (const std::uint16_t sample : samples) {
    if (shape.depth == 16) bytes.push_back(static_cast<png_byte>(sample >> 8));
    bytes.push_back(static_cast<png_byte>(sample & 0xff));
  }
  const std::size_t row_bytes = bytes.size() / static_cast<std::size_t>(shape.height);
  for (std::size_t y = 0; y < static_cast<std::size_t>(shape.height); ++y) png_write_row(png, &bytes[y * row_bytes]);
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  std::fclose(file);
}

}  // namespace moiregauge::internal
