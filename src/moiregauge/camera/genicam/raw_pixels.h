// SPDX-License-Identifier: Apache-2.0
// Converts the pixels that a GenICam camera sends to luma at their native depth. Formats are numbered as in the Pixel
// Format Naming Convention (PFNC 2.1).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/image/image.h"

namespace moiregauge::internal {

// Reduction of a colour mosaic to grey. Both give one pixel per cell of 2 x 2, at the cell's centre.
enum class MosaicGrey {
  kGreen,  // mean of the two green sites, whose centroid is the cell's centre
  kLuma,   // luma of the cell's colour. Red and blue sites move its centroid by a constant 0.09 px of the sensor
};

// Order of grey levels in memory.
enum class Packing {
  kWhole,      // one byte, or one little-endian word, per pixel
  kNibbles,    // GigE Vision 1.x: two pixels in three bytes, the low bits of both in the middle byte
  kBitStream,  // PFNC "p": the least significant bit first, without gaps
  kRgb,        // three bytes per pixel
  kBgr,
};

struct RawLayout {
  std::string_view name;  // PFNC name, e.g. "Mono12p"
  Packing packing = Packing::kWhole;
  int bits = 8;    // bits per grey level
  int red_x = -1;  // site of red in a mosaic cell, 0 or 1; -1: no mosaic
  int red_y = -1;
  [[nodiscard]] bool is_mosaic() const { return red_x >= 0; }
};

// Returns the layout of a format. Returns nothing for formats without luma, e.g. YUV, depth or signed data.
[[nodiscard]] std::optional<RawLayout> raw_layout(std::uint32_t pfnc);

// Pixels of one frame as received.
struct RawPixels {
  std::span<const std::uint8_t> bytes;
  int width = 0;          // px
  int height = 0;         // px
  int padding_bytes = 0;  // after each row
};

// Converts the frames of one camera. Owns the converted pixels.
class RawToLuma {
 public:
  explicit RawToLuma(const RawLayout& layout, MosaicGrey mosaic = MosaicGrey::kGreen)
      : layout_(layout), mosaic_(mosaic) {}
  // Returns the luma. It is valid until the next call, and as long as the received bytes, which whole pixels borrow.
  // Fails if the bytes are fewer than the size requires: a truncated frame must not be measured.
  [[nodiscard]] tl::expected<LumaView, std::string> luma(const RawPixels& raw);

 private:
  [[nodiscard]] LumaView whole(const RawPixels& raw);
  void unpack(const RawPixels& raw);
  void mix_colours(const RawPixels& raw);
  template <typename Grey>
  [[nodiscard]] ImageView<Grey> cells(ImageView<Grey> sites, std::vector<Grey>& out) const;

  RawLayout layout_;
  MosaicGrey mosaic_;
  std::vector<std::uint8_t> bytes_;
  std::vector<std::uint16_t> words_;
  std::vector<std::uint8_t> byte_cells_;
  std::vector<std::uint16_t> word_cells_;
};

}  // namespace moiregauge::internal
