// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/report/page_picture.h"

#include <algorithm>
#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <jpeglib.h>

#include "moiregauge/drawing/surface/surface.h"

namespace moiregauge::internal {
namespace {

constexpr int kWidest = 1600;  // px: the width of the page's column on a screen of double density
constexpr int kQuality = 85;   // from 0 to 100; keeps thin lines and letters sharp (chosen)

cairo_status_t next_bytes(void* left_of_file, unsigned char* data, unsigned int length) {
  auto& left = *static_cast<std::span<const std::uint8_t>*>(left_of_file);
  if (left.size() < length) return CAIRO_STATUS_READ_ERROR;
  std::memcpy(data, left.data(), length);
  left = left.subspan(length);
  return CAIRO_STATUS_SUCCESS;
}

Surface shrunk_to_page(cairo_surface_t* picture) {
  const int width = cairo_image_surface_get_width(picture), height = cairo_image_surface_get_height(picture);
  const double scale = std::min(1.0, static_cast<double>(kWidest) / width);
  const int rows = std::max(1, static_cast<int>(std::lround(scale * height)));
  Surface page(cairo_image_surface_create(CAIRO_FORMAT_RGB24, std::min(width, kWidest), rows), cairo_surface_destroy);
  const Context context(cairo_create(page.get()), cairo_destroy);
  cairo_scale(context.get(), scale, scale);
  cairo_set_source_surface(context.get(), picture, 0.0, 0.0);
  cairo_pattern_set_filter(cairo_get_source(context.get()), CAIRO_FILTER_GOOD);  // averages the source pixels per pixel
  cairo_paint(context.get());
  cairo_surface_flush(page.get());
  return page;
}

// libjpeg reports errors by longjmp. Objects with destructors are here, outside the function that it leaves.
struct JpegBytes {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  std::jmp_buf out_of_here{};
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  std::vector<std::uint8_t> row;
  JpegBytes() = default;
  JpegBytes(const JpegBytes&) = delete;
  JpegBytes& operator=(const JpegBytes&) = delete;
  ~JpegBytes() {
    jpeg_destroy_compress(&jpeg);
    std::free(bytes);
  }
};

[[noreturn]] void leave(j_common_ptr jpeg) { std::longjmp(static_cast<JpegBytes*>(jpeg->client_data)->out_of_here, 1); }

// Converts Cairo's words 0x00RRGGBB to the three bytes that libjpeg reads.
void put_rgb(const std::uint8_t* words, std::vector<std::uint8_t>& row) {
  for (std::size_t x = 0; x < row.size() / 3; ++x) {
    std::uint32_t word = 0;
    std::memcpy(&word, words + 4 * x, 4);
    for (std::size_t k = 0; k < 3; ++k) row[3 * x + k] = static_cast<std::uint8_t>(word >> (16 - 8 * k));
  }
}

bool write_jpeg(cairo_surface_t* page, JpegBytes& out) {
  out.jpeg.err = jpeg_std_error(&out.errors);
  out.errors.error_exit = &leave;
  out.jpeg.client_data = &out;
  if (setjmp(out.out_of_here) != 0) return false;
  jpeg_create_compress(&out.jpeg);
  jpeg_mem_dest(&out.jpeg, &out.bytes, &out.size);
  out.jpeg.image_width = static_cast<JDIMENSION>(cairo_image_surface_get_width(page));
  out.jpeg.image_height = static_cast<JDIMENSION>(cairo_image_surface_get_height(page));
  out.jpeg.input_components = 3;
  out.jpeg.in_color_space = JCS_RGB;
  jpeg_set_defaults(&out.jpeg);
  jpeg_set_quality(&out.jpeg, kQuality, TRUE);
  out.jpeg.optimize_coding = TRUE;
  jpeg_start_compress(&out.jpeg, TRUE);
  const std::uint8_t* words = cairo_image_surface_get_data(page);
  const int stride = cairo_image_surface_get_stride(page);
  while (out.jpeg.next_scanline < out.jpeg.image_height) {
    put_rgb(words + static_cast<std::ptrdiff_t>(out.jpeg.next_scanline) * stride, out.row);
    JSAMPROW row = out.row.data();
    jpeg_write_scanlines(&out.jpeg, &row, 1);
  }
  jpeg_finish_compress(&out.jpeg);
  return true;
}

}  // namespace

std::vector<std::uint8_t> page_picture(std::span<const std::uint8_t> png) {
  const auto as_it_is = [&] { return std::vector<std::uint8_t>(png.begin(), png.end()); };
  std::span<const std::uint8_t> left = png;
  const Surface picture(cairo_image_surface_create_from_png_stream(next_bytes, &left), cairo_surface_destroy);
  if (cairo_surface_status(picture.get()) != CAIRO_STATUS_SUCCESS) return as_it_is();
  const Surface page = shrunk_to_page(picture.get());
  if (cairo_surface_status(page.get()) != CAIRO_STATUS_SUCCESS) return as_it_is();
  JpegBytes out;
  out.row.resize(static_cast<std::size_t>(3 * cairo_image_surface_get_width(page.get())));
  if (!write_jpeg(page.get(), out) || out.size >= png.size()) return as_it_is();
  return {out.bytes, out.bytes + out.size};
}

}  // namespace moiregauge::internal
