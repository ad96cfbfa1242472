// SPDX-License-Identifier: Apache-2.0
// Rows of a window of an image, for loops over vectors of pixels. Rows of an image are kilobytes apart, so the processor
// cannot predict where the next row of a window begins.
#pragma once

#include <algorithm>

#include "moiregauge/image/image.h"

namespace moiregauge::internal {

// Prefetches the pixels x0 to x1 (inclusive) of row y, which must be inside the image. It is a hint and changes
// nothing.
template <typename Grey>
inline void fetch_row(const ImageView<Grey>& picture, int y, int x0, int x1) {
  constexpr int kLine = 64 / static_cast<int>(sizeof(Grey));  // pixels in a cache line of 64 bytes
  const Grey* const row = picture.row(y).data();
  for (int x = x0; x < x1 + kLine; x += kLine) __builtin_prefetch(row + std::min(x, x1));
}

// Copies the grey levels from (x, y) to the end of the row, and zeros beyond it. Never inlined: a loop that seldom needs
// it keeps its vectors in registers.
template <typename Grey, std::size_t kCount>
[[gnu::noinline]] void copy_to_row_end(const ImageView<Grey>& picture, int x, int y, Grey (&edge)[kCount]) {
  std::fill_n(edge, kCount, Grey{0});
  std::copy_n(picture.row(y).data() + x, picture.width - x, edge);
}

// Returns the grey levels from (x, y) on, as many as `edge` holds. Those beyond the image are zero, and its memory is not
// read there.
template <typename Grey, std::size_t kCount>
[[gnu::always_inline]] inline const Grey* pixels_from(const ImageView<Grey>& picture, int x, int y,
                                                      Grey (&edge)[kCount]) {
  if (x + static_cast<int>(kCount) <= picture.width) return picture.row(y).data() + x;
  copy_to_row_end(picture, x, y, edge);
  return edge;
}

}  // namespace moiregauge::internal
