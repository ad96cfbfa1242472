// SPDX-License-Identifier: Apache-2.0
// Rows of a picture lie kilobytes apart: no processor foresees where the next one of a window begins.
#pragma once

#include <algorithm>

#include "moiregauge/image/image.h"

namespace moiregauge::internal {

// Asks for the pixels from x0 to x1 of row y, ends included, which must lie in the picture; a hint that changes nothing.
template <typename Grey>
inline void fetch_row(const ImageView<Grey>& picture, int y, int x0, int x1) {
  constexpr int kLine = 64 / static_cast<int>(sizeof(Grey));
  const Grey* const row = picture.row(y).data();
  for (int x = x0; x < x1 + kLine; x += kLine) __builtin_prefetch(row + std::min(x, x1));
}

}  // namespace moiregauge::internal
