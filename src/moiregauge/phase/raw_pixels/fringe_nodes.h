// SPDX-License-Identifier: Apache-2.0
// Sampling moiré on raw pixels, at the grating's own pitch (T = P). The linear interpolation, the T-point DFT and the mean
// over a cell are one weighted sum of pixels, so no raster is interpolated (docs/methods/sampling-moire.md). Each of
// sixteen adjacent pixels has a lane. Lanes are added in one fixed order, and no product is fused with a sum. So every
// SIMD target gives the same bits (Highway, chosen at run time; decision 0016).
#pragma once

#include <array>

#include "moiregauge/image/image.h"
#include "moiregauge/phase/raw_pixels/fringe_map.h"
#include "moiregauge/phase/sampling_moire/sampling_moire.h"

namespace moiregauge::internal {

// Averaged region of a grating: square cells, whose windows add up to that of the region.
struct FringeRegion {
  double side = 1.0;  // periods
  int nodes = 1;      // cells per side, at most kMaxNodes
  // Returns half the side of the window: that of the region, and one period for the interpolation.
  [[nodiscard]] double window() const { return 0.5 * side + 1.0; }
};
inline constexpr int kMaxNodes = 12;

// Returns the fringes along X and Y at the middles of the cells. Their carrier is removed.
//     z(k, l) ~ (a/2) exp(i (phi - 2 pi X))
// Each is the mean of the fringe by sampling_moire over its cell. Their sampling pitch is in nodes. `box` contains the
// window and lies inside the image. `background` is subtracted from the grey levels, because the pixels' edges leave a
// trace of a constant in the fringe.
// Error: below 2e-4 px for binary gratings of 5 px or more (EveryPattern.IsReadWhereItIs).
[[nodiscard]] std::array<FringeField, 2> fringe_nodes(const LumaView& luma, const FringeMap& map,
                                                      const FringeRegion& region, const PixelBox& box,
                                                      double background);

}  // namespace moiregauge::internal
