// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/drawing/surface/png_bytes.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <memory>
#include <span>

#include <gtest/gtest.h>

#include "moiregauge/drawing/surface/surface.h"

namespace moiregauge::internal {
namespace {

constexpr int kWidth = 37, kHeight = 23;

cairo_status_t take(void* closure, unsigned char* data, unsigned int length) {
  auto& left = *static_cast<std::span<const std::uint8_t>*>(closure);
  if (left.size() < length) return CAIRO_STATUS_READ_ERROR;
  std::copy_n(left.begin(), length, data);
  left = left.subspan(length);
  return CAIRO_STATUS_SUCCESS;
}

std::uint32_t pixel(cairo_surface_t* surface, int x, int y) {
  std::uint32_t word = 0;
  std::memcpy(&word,
              cairo_image_surface_get_data(surface) +
                  static_cast<std::ptrdiff_t>(y) * cairo_image_surface_get_stride(surface) + 4 * x,
              4);
  return word & 0xffffffU;
}

TEST(PngBytes, CairoReadsEveryPixelBack) {
  const Surface page(cairo_image_surface_create(CAIRO_FORMAT_RGB24, kWidth, kHeight), cairo_surface_destroy);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const std::uint32_t word = 0x010305U * static_cast<std::uint32_t>(x) + 0x070200U * static_cast<std::uint32_t>(y);
      std::memcpy(cairo_image_surface_get_data(page.get()) +
                      static_cast<std::ptrdiff_t>(y) * cairo_image_surface_get_stride(page.get()) + 4 * x,
                  &word, 4);
    }
  }
  cairo_surface_mark_dirty(page.get());
  const auto bytes = png_of(page.get());
  std::span<const std::uint8_t> left(bytes);
  const Surface read(cairo_image_surface_create_from_png_stream(take, &left), cairo_surface_destroy);
  ASSERT_EQ(cairo_surface_status(read.get()), CAIRO_STATUS_SUCCESS);
  ASSERT_EQ(cairo_image_surface_get_width(read.get()), kWidth);
  ASSERT_EQ(cairo_image_surface_get_height(read.get()), kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) EXPECT_EQ(pixel(read.get(), x, y), pixel(page.get(), x, y)) << x << ", " << y;
  }
}

TEST(PngBytes, WithoutASurfaceAreEmpty) {
  const Surface none(cairo_image_surface_create(CAIRO_FORMAT_RGB24, -1, 5), cairo_surface_destroy);
  EXPECT_TRUE(png_of(none.get()).empty());
}

}  // namespace
}  // namespace moiregauge::internal
