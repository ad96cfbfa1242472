// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "moiregauge/image/tone.h"

struct AVFrame;

namespace moiregauge::internal {

// Returns the tone curve that a decoded frame states (ITU-T H.273, transfer characteristics), or the usual one of its
// pixels: linear of grey, sRGB of RGB, JPEG's of full-range YUV, BT.709 of all other YUV.
[[nodiscard]] Tone tone_of(const AVFrame& frame);

}  // namespace moiregauge::internal
