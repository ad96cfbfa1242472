// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "moiregauge/image/tone.h"

struct AVFrame;

namespace moiregauge::internal {

// Returns the tone curve that a decoded frame states (ITU-T H.273, transfer characteristics), or the usual one of its
// pixels. Usual are: linear for grey, sRGB for RGB and full-range YUV of JPEG, BT.709 for other YUV.
[[nodiscard]] Tone tone_of(const AVFrame& frame);

}  // namespace moiregauge::internal
