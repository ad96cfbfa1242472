// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/pictures/luma_jpeg.h"

#include <algorithm>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include <jpeglib.h>

namespace moiregauge::internal {
namespace {

constexpr int kQuality = 82;  // from 0 to 100; gratings stay sharp at half the bytes of 92 (chosen)

// libjpeg reports errors by longjmp. Objects with destructors are here, outside the function that it leaves.
struct JpegOutput {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  std::jmp_buf on_error{};
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
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

bool compress(const ImageView<std::uint8_t>& image, JpegOutput& out) {
  out.jpeg.err = jpeg_std_error(&out.errors);
  out.errors.error_exit = &jump_on_error;
  out.jpeg.client_data = &out;
  if (setjmp(out.on_error) != 0) return false;
  jpeg_create_compress(&out.jpeg);
  jpeg_mem_dest(&out.jpeg, &out.bytes, &out.size);
  out.jpeg.image_width = static_cast<JDIMENSION>(image.width);
  out.jpeg.image_height = static_cast<JDIMENSION>(image.height);
  out.jpeg.input_components = 1;
  out.jpeg.in_color_space = JCS_GRAYSCALE;
  jpeg_set_defaults(&out.jpeg);
  jpeg_set_quality(&out.jpeg, kQuality, TRUE);
  jpeg_start_compress(&out.jpeg, TRUE);
  while (out.jpeg.next_scanline < out.jpeg.image_height) {
    const std::uint8_t* first = image.data + static_cast<std::ptrdiff_t>(out.jpeg.next_scanline) * image.stride;
    // libjpeg does not write to the row, but its interface is not const.
    JSAMPROW row = const_cast<JSAMPROW>(first);
    jpeg_write_scanlines(&out.jpeg, &row, 1);
  }
  jpeg_finish_compress(&out.jpeg);
  return true;
}

}  // namespace

Image<std::uint8_t> shrunk_to_width(const ImageView<std::uint8_t>& image, int max_width) {
  const int n = std::max(1, (image.width + max_width - 1) / std::max(1, max_width));
  Image<std::uint8_t> out(std::max(1, image.width / n), std::max(1, image.height / n));
  std::vector<std::uint32_t> sums(static_cast<std::size_t>(out.width()));
  for (int y = 0; y < out.height(); ++y) {
    std::ranges::fill(sums, 0U);
    for (int k = 0; k < std::min(n, image.height); ++k) {
      const auto row = image.row(y * n + k);
      for (std::size_t x = 0; x < sums.size(); ++x) {
        const auto block =
            row.subspan(x * static_cast<std::size_t>(n), static_cast<std::size_t>(std::min(n, image.width)));
        for (const std::uint8_t grey : block) sums[x] += grey;
      }
    }
    const auto count = static_cast<std::uint32_t>(std::min(n, image.width) * std::min(n, image.height));
    std::ranges::transform(sums, out.row(y).begin(),
                           [count](std::uint32_t sum) { return static_cast<std::uint8_t>((sum + count / 2) / count); });
  }
  return out;
}

std::string luma_jpeg(const ImageView<std::uint8_t>& image) {
  JpegOutput out;
  if (!compress(image, out)) return {};
  return {reinterpret_cast<const char*>(out.bytes), out.size};
}

}  // namespace moiregauge::internal
