// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/report/page_picture.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "moiregauge/base/jpeg_bytes.h"
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

// Converts Cairo's words 0x00RRGGBB to the three bytes that libjpeg reads.
void put_rgb(const std::uint8_t* words, std::span<std::uint8_t> row) {
  for (std::size_t x = 0; x < row.size() / 3; ++x) {
    std::uint32_t word = 0;
    std::memcpy(&word, words + 4 * x, 4);
    for (std::size_t k = 0; k < 3; ++k) row[3 * x + k] = static_cast<std::uint8_t>(word >> (16 - 8 * k));
  }
}

std::string jpeg_of(cairo_surface_t* page) {
  const std::uint8_t* words = cairo_image_surface_get_data(page);
  const std::ptrdiff_t stride = cairo_image_surface_get_stride(page);
  return jpeg_bytes({.width = cairo_image_surface_get_width(page),
                     .height = cairo_image_surface_get_height(page),
                     .components = 3,
                     .quality = kQuality,
                     .is_small = true,
                     .fill = [=](int y, std::span<std::uint8_t> row) { put_rgb(words + y * stride, row); }});
}

}  // namespace

std::vector<std::uint8_t> page_picture(std::span<const std::uint8_t> png) {
  const auto as_it_is = [&] { return std::vector<std::uint8_t>(png.begin(), png.end()); };
  std::span<const std::uint8_t> left = png;
  const Surface picture(cairo_image_surface_create_from_png_stream(next_bytes, &left), cairo_surface_destroy);
  if (cairo_surface_status(picture.get()) != CAIRO_STATUS_SUCCESS) return as_it_is();
  const Surface page = shrunk_to_page(picture.get());
  if (cairo_surface_status(page.get()) != CAIRO_STATUS_SUCCESS) return as_it_is();
  const std::string jpeg = jpeg_of(page.get());
  if (jpeg.empty() || jpeg.size() >= png.size()) return as_it_is();
  return {jpeg.begin(), jpeg.end()};
}

}  // namespace moiregauge::internal
