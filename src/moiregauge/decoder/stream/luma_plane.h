// SPDX-License-Identifier: Apache-2.0
// Copies the luma of a decoded frame at its native depth, for any pixel format.
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

// Returns the layout by the format's descriptor. Returns nothing for formats without a stored luma plane: palettes,
// Bayer mosaics, floating point, hardware surfaces, fewer than 8 bits.
[[nodiscard]] std::optional<LumaLayout> luma_layout(AVPixelFormat format);

// Writes the luma with packed rows, as 8-bit words for 8 bits and 16-bit words above. The range stays as stored.
void copy_luma(const AVFrame& frame, const LumaLayout& layout, std::byte* out);

}  // namespace moiregauge::internal
