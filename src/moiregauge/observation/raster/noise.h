// SPDX-License-Identifier: Apache-2.0
// Noise of the raw pixels around a marker, from the image itself.
#pragma once

#include "moiregauge/image/image.h"

namespace moiregauge::internal {

struct PixelNoise {
  // Noise of one pixel, grey levels, including the rounding to whole grey levels.
  double sigma = 0.0;
  double clipped_share = 0.0;  // share of pixels at 0 or at the highest grey level of `bits`
};

// Estimates the noise in an image or a part of it (part_of). The estimate is 1.4826 / 6 of the median magnitude of a
// mask.
//     [1 -2 1; -2 4 -2; 1 -2 1]
// The mask ignores planes and any pattern f(x) + g(y). On a binary grating most pixels are flat, so the median is
// noise. With pitches of a few pixels it is too high, never too low. After J. Immerkaer, Fast noise variance
// estimation, CVIU 64 (1996), doi:10.1006/cviu.1996.0060.
[[nodiscard]] PixelNoise pixel_noise(const LumaView& part, int bits);

// Returns the clipped share alone.
[[nodiscard]] double clipped_share(const LumaView& part, int bits);

}  // namespace moiregauge::internal
