// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/pictures/luma_jpeg.h"

#include <algorithm>
#include <span>
#include <vector>

#include "moiregauge/base/jpeg_bytes.h"

namespace moiregauge::internal {
namespace {

constexpr int kQuality = 82;  // from 0 to 100; gratings stay sharp at half the bytes of 92 (chosen)

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
  const auto fill = [&](int y, std::span<std::uint8_t> bytes) { std::ranges::copy(image.row(y), bytes.begin()); };
  return jpeg_bytes({.width = image.width, .height = image.height, .quality = kQuality, .fill = fill});
}

}  // namespace moiregauge::internal
