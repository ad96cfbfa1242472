// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/decoder/stream/luma_plane.h"

#include <bit>
#include <cstdint>
#include <cstring>

#include "moiregauge/image/luma_of_colour.h"

namespace moiregauge::internal {
namespace {

static_assert(std::endian::native == std::endian::little, "samples are read as little-endian words");

// Returns one sample of one component, in the low bits.
template <typename Grey>
Grey sample_at(const std::uint8_t* at, const AVComponentDescriptor& part, bool big_endian) {
  if constexpr (sizeof(Grey) == 1) {
    return *at;
  } else {
    std::uint16_t word = 0;
    std::memcpy(&word, at, sizeof word);
    if (big_endian) word = static_cast<std::uint16_t>(word << 8 | word >> 8);
    return static_cast<Grey>((word >> part.shift) & ((1U << part.depth) - 1U));
  }
}

const std::uint8_t* row_of(const AVFrame& frame, const AVComponentDescriptor& part, int y) {
  return frame.data[part.plane] + static_cast<std::ptrdiff_t>(y) * frame.linesize[part.plane] + part.offset;
}

template <typename Grey>
void copy_rows(const AVFrame& frame, const LumaLayout& layout, Grey* out) {
  const auto& [first, second, third] = layout.part;
  const auto width = static_cast<std::size_t>(frame.width);
  const bool as_it_lies = layout.parts == 1 && first.step == static_cast<int>(sizeof(Grey)) && first.shift == 0 &&
                          !(layout.big_endian && sizeof(Grey) == 2);
  for (int y = 0; y < frame.height; ++y, out += width) {
    const std::uint8_t* a = row_of(frame, first, y);
    if (as_it_lies) {
      std::memcpy(out, a, width * sizeof(Grey));
    } else if (layout.parts == 1) {
      for (std::size_t x = 0; x < width; ++x, a += first.step) out[x] = sample_at<Grey>(a, first, layout.big_endian);
    } else {
      const std::uint8_t* b = row_of(frame, second, y);
      const std::uint8_t* c = row_of(frame, third, y);
      for (std::size_t x = 0; x < width; ++x, a += first.step, b += second.step, c += third.step) {
        out[x] = luma_of_colour<Grey>(sample_at<Grey>(a, first, layout.big_endian),
                                      sample_at<Grey>(b, second, layout.big_endian),
                                      sample_at<Grey>(c, third, layout.big_endian));
      }
    }
  }
}

}  // namespace

std::optional<LumaLayout> luma_layout(AVPixelFormat format) {
  const AVPixFmtDescriptor* described = av_pix_fmt_desc_get(format);
  constexpr std::uint64_t kNoLuma = AV_PIX_FMT_FLAG_HWACCEL | AV_PIX_FMT_FLAG_BAYER | AV_PIX_FMT_FLAG_PAL |
                                    AV_PIX_FMT_FLAG_BITSTREAM | AV_PIX_FMT_FLAG_FLOAT;
  if (described == nullptr || (described->flags & kNoLuma) != 0) return std::nullopt;
  if (std::strncmp(described->name, "xyz", 3) == 0) return std::nullopt;  // the descriptor of CIE XYZ looks like YUV
  LumaLayout layout;
  layout.parts = (described->flags & AV_PIX_FMT_FLAG_RGB) != 0 ? 3 : 1;
  if (described->nb_components < layout.parts) return std::nullopt;
  layout.bits = described->comp[0].depth;
  layout.big_endian = (described->flags & AV_PIX_FMT_FLAG_BE) != 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(layout.parts); ++i) {
    layout.part[i] = described->comp[i];
    const AVComponentDescriptor& part = layout.part[i];
    if (part.depth != layout.bits || part.depth < 8 || part.depth > 16) return std::nullopt;
    if (part.depth == 8 && part.shift != 0) return std::nullopt;
    if (part.depth > 8 && part.depth + part.shift > 16) return std::nullopt;  // packed across words
  }
  return layout;
}

void copy_luma(const AVFrame& frame, const LumaLayout& layout, std::byte* out) {
  if (layout.bits == 8)
    copy_rows(frame, layout, reinterpret_cast<std::uint8_t*>(out));
  else
    copy_rows(frame, layout, reinterpret_cast<std::uint16_t*>(out));
}

}  // namespace moiregauge::internal
