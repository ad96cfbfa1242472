// SPDX-License-Identifier: Apache-2.0
// Test for a step in the tone curve: grey levels that the edges of discs never show.
// A blurred edge passes through all levels from dark to light, and the rim of a disc crosses the pixel grid at all
// phases. Histogram equalisation and similar curves have steps, which round an edge's position to whole pixels.
#pragma once

#include <array>

#include "moiregauge/image/image.h"

namespace moiregauge::internal {

// Levels of a disc's edge are relative: 0 in the disc, 1 on the paper around it.
inline constexpr double kLowestEdgeLevel = 0.15;
inline constexpr double kHighestEdgeLevel = 0.85;
inline constexpr int kEdgeBins = 14;    // each covers 0.05 between these levels
inline constexpr int kEdgeBinsGap = 6;  // bins of a gap: a range of 0.3

class EdgeLevels {
 public:
  // Adds the edge pixels of a disc with its centre and diameter in px. A disc that the image cuts off adds nothing.
  void add_disc(const LumaView& luma, double centre_x, double centre_y, double diameter_px);
  // Returns the number of edge pixels between the lowest and the highest level. It is at least that of an image without
  // blur, in which pixels along the rim are partly covered: 0.7 per px of its length.
  [[nodiscard]] long all() const;
  // Returns the smallest number of edge pixels in any range of 0.3. Without a step a range has at least a quarter of all
  // pixels: a Gaussian edge has 0.28.
  [[nodiscard]] long in_emptiest_range() const;

 private:
  std::array<long, kEdgeBins> bins_{};
  double rim_px_ = 0.0;  // length of all edges
};

}  // namespace moiregauge::internal
