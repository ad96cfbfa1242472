// SPDX-License-Identifier: Apache-2.0
// Noise of the raw pixels round a marker, from the picture itself.
#pragma once

#include "moiregauge/image/image.h"

namespace moiregauge::internal {

struct PixelNoise {
  double sigma = 0.0;          // grey levels, one pixel, including the rounding to whole grey levels
  double clipped_share = 0.0;  // of pixels at 0 or at the highest grey level of `bits`
};

// Robust scale (1.4826 x the median magnitude, over 6) of the mask [1 -2 1; -2 4 -2; 1 -2 1], which is blind to planes and
// to any pattern f(x) + g(y): after J. Immerkaer, Fast noise variance estimation, CVIU 64 (1996), doi:10.1006/cviu.1996.0060.
// On a binary print most pixels are flat, so the median is noise; with pitches of a few pixels it reads high, never low.
// The box is clipped to the picture.
[[nodiscard]] PixelNoise pixel_noise(const LumaView& luma, int bits, int x0, int y0, int width, int height);

// The second of these by itself.
[[nodiscard]] double clipped_share(const LumaView& luma, int bits, int x0, int y0, int width, int height);

}  // namespace moiregauge::internal
