// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/drawing/surface/png_bytes.h"

#include <csetjmp>
#include <cstddef>

#include <png.h>

namespace moiregauge::internal {
namespace {

// zlib level. cairo uses level 6 and tries every filter on every row, which takes 7 times longer and saves 10 %.
constexpr int kLevel = 2;

struct Writer {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png == nullptr ? nullptr : png_create_info_struct(png);
  Writer() = default;
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
  ~Writer() { png_destroy_write_struct(&png, &info); }
};

void append_png(png_structp png, png_bytep data, std::size_t length) {
  auto* bytes = static_cast<std::vector<std::uint8_t>*>(png_get_io_ptr(png));
  bytes->insert(bytes->end(), data, data + length);
}

// Returns false after an error of libpng, which leaves by longjmp. No object with a destructor may be created here.
bool write_surface(Writer& writer, cairo_surface_t* surface, std::vector<std::uint8_t>& bytes) {
  if (setjmp(png_jmpbuf(writer.png)) != 0) return false;
  const int width = cairo_image_surface_get_width(surface), height = cairo_image_surface_get_height(surface);
  png_set_write_fn(writer.png, &bytes, append_png, nullptr);
  png_set_compression_level(writer.png, kLevel);
  png_set_filter(writer.png, 0, PNG_FILTER_NONE);
  png_set_IHDR(writer.png, writer.info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), 8,
               PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(writer.png, writer.info);
  // A pixel is a word 0x00RRGGBB in the machine's byte order, which is little-endian on all supported machines.
  png_set_filler(writer.png, 0, PNG_FILLER_AFTER);
  png_set_bgr(writer.png);
  const unsigned char* const data = cairo_image_surface_get_data(surface);
  const int stride = cairo_image_surface_get_stride(surface);
  for (int y = 0; y < height; ++y) png_write_row(writer.png, data + static_cast<std::ptrdiff_t>(y) * stride);
  png_write_end(writer.png, nullptr);
  return true;
}

}  // namespace

std::vector<std::uint8_t> png_of(cairo_surface_t* surface) {
  std::vector<std::uint8_t> bytes;
  cairo_surface_flush(surface);
  if (cairo_surface_status(surface) != CAIRO_STATUS_SUCCESS) return bytes;
  if (cairo_image_surface_get_format(surface) != CAIRO_FORMAT_RGB24) return bytes;
  Writer writer;
  if (writer.info == nullptr || !write_surface(writer, surface, bytes)) bytes.clear();
  return bytes;
}

}  // namespace moiregauge::internal
