// SPDX-License-Identifier: Apache-2.0
// Images of grey levels, owned (Image) and borrowed (ImageView). Pixel (0,0) is the centre of the top-left pixel.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

namespace moiregauge::internal {

// Read-only view of pixels that belong to others. It is passed by value and never owns memory.
template <typename Grey>
struct ImageView {
  const Grey* data = nullptr;
  int width = 0;              // pixels
  int height = 0;             // pixels
  std::ptrdiff_t stride = 0;  // elements from one row to the next

  [[nodiscard]] std::span<const Grey> row(int y) const { return {data + y * stride, static_cast<std::size_t>(width)}; }
  [[nodiscard]] Grey at(int x, int y) const { return data[y * stride + x]; }
  // Returns the part with top-left pixel (x0, y0). The caller must keep it inside the image.
  [[nodiscard]] ImageView part(int x0, int y0, int part_width, int part_height) const {
    return {data + y0 * stride + x0, part_width, part_height, stride};
  }
};

// Image that owns its pixels, rows packed.
template <typename Grey>
class Image {
 public:
  Image() = default;
  Image(int width, int height, Grey fill = Grey{})
      : width_(width),
        height_(height),
        pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), fill) {}
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] std::span<Grey> row(int y) { return {pixels_.data() + offset(y), static_cast<std::size_t>(width_)}; }
  [[nodiscard]] std::span<const Grey> row(int y) const {
    return {pixels_.data() + offset(y), static_cast<std::size_t>(width_)};
  }
  [[nodiscard]] Grey& at(int x, int y) { return pixels_[offset(y) + static_cast<std::size_t>(x)]; }
  [[nodiscard]] Grey at(int x, int y) const { return pixels_[offset(y) + static_cast<std::size_t>(x)]; }
  [[nodiscard]] ImageView<Grey> view() const { return {pixels_.data(), width_, height_, width_}; }

 private:
  [[nodiscard]] std::size_t offset(int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
  }
  int width_ = 0;
  int height_ = 0;
  std::vector<Grey> pixels_;
};

// Range of pixels, both ends included.
struct PixelBox {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

// Luma plane of one frame at its native depth: 8 bits, or 9 to 16 bits in the low bits of 16-bit words.
using LumaView = std::variant<ImageView<std::uint8_t>, ImageView<std::uint16_t>>;

[[nodiscard]] inline int width_of(const LumaView& luma) {
  return std::visit([](const auto& view) { return view.width; }, luma);
}
[[nodiscard]] inline int height_of(const LumaView& luma) {
  return std::visit([](const auto& view) { return view.height; }, luma);
}
// Returns the part of an image from (x0, y0) to before (x1, y1), clipped to the image.
[[nodiscard]] inline LumaView part_of(const LumaView& luma, int x0, int y0, int x1, int y1) {
  return std::visit(
      [&](const auto& picture) -> LumaView {
        const int left = std::clamp(x0, 0, picture.width), top = std::clamp(y0, 0, picture.height);
        const int right = std::clamp(x1, left, picture.width), bottom = std::clamp(y1, top, picture.height);
        return picture.part(left, top, right - left, bottom - top);
      },
      luma);
}

}  // namespace moiregauge::internal
