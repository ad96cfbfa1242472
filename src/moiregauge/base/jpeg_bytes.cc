// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/base/jpeg_bytes.h"

#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include <jpeglib.h>

namespace moiregauge::internal {
namespace {

// libjpeg reports errors by longjmp. Objects with destructors are here, outside the function that it leaves.
struct JpegOutput {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  std::jmp_buf on_error{};
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  std::vector<std::uint8_t> row;
  JpegOutput() = default;
  JpegOutput(const JpegOutput&) = delete;
  JpegOutput& operator=(const JpegOutput&) = delete;
  ~JpegOutput() {
    jpeg_destroy_compress(&jpeg);
    std::free(bytes);
  }
};

[[noreturn]] void jump_on_error(j_common_ptr jpeg) {
  std::longjmp(static_cast<JpegOutput*>(jpeg->client_data)->on_error, 1);
}

bool compress(const JpegRows& picture, JpegOutput& out) {
  out.jpeg.err = jpeg_std_error(&out.errors);
  out.errors.error_exit = &jump_on_error;
  out.jpeg.client_data = &out;
  if (setjmp(out.on_error) != 0) return false;
  jpeg_create_compress(&out.jpeg);
  jpeg_mem_dest(&out.jpeg, &out.bytes, &out.size);
  out.jpeg.image_width = static_cast<JDIMENSION>(picture.width);
  out.jpeg.image_height = static_cast<JDIMENSION>(picture.height);
  out.jpeg.input_components = picture.components;
  out.jpeg.in_color_space = picture.components == 1 ? JCS_GRAYSCALE : JCS_RGB;
  jpeg_set_defaults(&out.jpeg);
  jpeg_set_quality(&out.jpeg, picture.quality, TRUE);
  out.jpeg.optimize_coding = picture.is_small ? TRUE : FALSE;
  jpeg_start_compress(&out.jpeg, TRUE);
  while (out.jpeg.next_scanline < out.jpeg.image_height) {
    picture.fill(static_cast<int>(out.jpeg.next_scanline), out.row);
    JSAMPROW row = out.row.data();
    jpeg_write_scanlines(&out.jpeg, &row, 1);
  }
  jpeg_finish_compress(&out.jpeg);
  return true;
}

}  // namespace

std::string jpeg_bytes(const JpegRows& picture) {
  JpegOutput out;
  out.row.resize(static_cast<std::size_t>(picture.components) * static_cast<std::size_t>(picture.width));
  if (!compress(picture, out)) return {};
  return {reinterpret_cast<const char*>(out.bytes), out.size};
}

}  // namespace moiregauge::internal
