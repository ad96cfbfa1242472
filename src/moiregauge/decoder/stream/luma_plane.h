// SPDX-License-Identifier: Apache-2.0
// The luma of a decoded frame at its native depth, wherever the pixel format keeps it.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

extern "C" {
#include <libavutil/frame.h>
#include <libavutil/pixdesc.h>
}

namespace moiregauge::internal {

struct LumaLayout {
  int bits = 8;
  int parts = 1;  // 1: luma or grey; 3: red, green, blue
  bool big_endian = false;
  std::array<AVComponentDescriptor, 3> part{};
};

// Read off the format's descriptor, not a list of names. Nothing for palettes, Bayer mosaics, floating point, hardware
// surfaces, fewer than 8 bits: none of these has a luma plane as stored.
[[nodiscard]] std::optional<LumaLayout> luma_layout(AVPixelFormat format);

// Writes the frame's luma, rows packed, 8-bit words for 8 bits and 16-bit words above; range as stored.
void copy_luma(const AVFrame& frame, const LumaLayout& layout, std::byte* out);

}  // namespace moiregauge::internal
