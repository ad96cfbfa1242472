// SPDX-License-Identifier: Apache-2.0
// Processing of one image after the camera's tone curve and before storage.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "moiregauge/image/image.h"
#include "moiregauge/simulator/scenario/scenario.h"

namespace moiregauge::internal::simulator {

// Parts of an image in which anything is drawn, in blocks of 16 x 16 px. The rest is a flat grey, which filters do not
// change.
class DrawnParts {
 public:
  DrawnParts(int width, int height);
  // Adds the pixels left..right - 1 of rows top..bottom - 1, clipped to the image.
  void add(int left, int top, int right, int bottom);
  // Calls act(from, to) for all intervals of pixels [from, to) of row y in these parts.
  template <typename Act>
  void for_each_run(int y, const Act& act) const {
    const std::size_t first = static_cast<std::size_t>(y / kBlock) * columns_;
    for (std::size_t column = 0; column < columns_; ++column) {
      if (is_drawn_[first + column] == 0) continue;
      const std::size_t from = column;
      while (column < columns_ && is_drawn_[first + column] != 0) ++column;
      act(static_cast<int>(from) * kBlock, std::min(static_cast<int>(column) * kBlock, width_));
    }
  }

 private:
  static constexpr int kBlock = 16;
  int width_, height_;
  std::size_t columns_;
  std::vector<std::uint8_t> is_drawn_;
};

// Returns true if `develop` would change an image.
[[nodiscard]] bool has_spatial_steps(const Processing& processing);
// Returns the distance in px over which a pixel affects others. Local tone mapping is not included.
[[nodiscard]] int reach_of(const Processing& processing);

// Applies median, bilateral filter, local tone mapping, unsharp mask, low-pass and larger pixels, in this order. Clips
// grey levels to 0 to 255 after each step. The result does not depend on the number of threads.
void develop(const Processing& processing, const DrawnParts& parts, Image<double>& picture);

}  // namespace moiregauge::internal::simulator
