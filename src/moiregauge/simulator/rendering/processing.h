// SPDX-License-Identifier: Apache-2.0
// The processing of one picture after the camera's tone curve and before it is stored.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "moiregauge/image/image.h"
#include "moiregauge/simulator/scenario/scenario.h"

namespace moiregauge::internal::simulator {

// The parts of a picture in which anything is drawn, in blocks of pixels: the rest is one flat grey, which filters leave
// as it is.
class DrawnParts {
 public:
  DrawnParts(int width, int height);
  // Adds pixels left..right of rows top..bottom, ends excluded; cut to the picture.
  void add(int left, int top, int right, int bottom);
  // Calls `act(from, to)` for every run of pixels of row y in any of them.
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

// True when `develop` would change anything.
[[nodiscard]] bool has_spatial_steps(const Processing& processing);
// Returns how far from a pixel others change it, px.
[[nodiscard]] int reach_of(const Processing& processing);

// Applies, in this order: median, bilateral filter, local tone mapping, unsharp mask, low-pass, larger pixels. Grey levels
// are cut to 0 to 255 after each. The same bits for any number of threads.
void develop(const Processing& processing, const DrawnParts& parts, Image<double>& picture);

}  // namespace moiregauge::internal::simulator
