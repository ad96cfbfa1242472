// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/decoder/stored/stored_video.h"

#include <algorithm>
#include <functional>

#include "moiregauge/decoder/child/wire.h"

namespace moiregauge::internal {
namespace {

enum class Planes { kGrey, k420 };
struct PixelKind {
  Planes planes = Planes::kGrey;
  int bits = 8;
};

constexpr std::uint32_t tag(char a, char b, char c, char d) {
  const auto byte = [](char v) { return std::uint32_t{static_cast<std::uint8_t>(v)}; };
  return byte(a) | byte(b) << 8U | byte(c) << 16U | byte(d) << 24U;
}

std::optional<PixelKind> kind_of(std::uint32_t fourcc) {
  switch (fourcc) {
    case tag('Y', '8', '0', '0'):
    case tag('G', 'R', 'E', 'Y'):
    case tag('Y', '8', ' ', ' '):
      return PixelKind{Planes::kGrey, 8};
    case tag('I', '4', '2', '0'):
    case tag('I', 'Y', 'U', 'V'):
    case tag('Y', 'V', '1', '2'):
    case tag('N', 'V', '1', '2'):
    case tag('N', 'V', '2', '1'):
      return PixelKind{Planes::k420, 8};
    default:
      break;
  }
  // ffmpeg's codes for more than 8 bits: 'Y' '1' 0 bits is grey, 'Y' '3' 11 bits is 4:2:0.
  const int bits = static_cast<int>(fourcc >> 24U);
  if (bits < 9 || bits > 16) return std::nullopt;
  if ((fourcc & 0xffffffU) == tag('Y', '1', 0, 0)) return PixelKind{Planes::kGrey, bits};
  if ((fourcc & 0xffffffU) == tag('Y', '3', 11, 0)) return PixelKind{Planes::k420, bits};
  return std::nullopt;
}

}  // namespace

std::optional<StoredPixels> stored_pixels(std::uint32_t fourcc, std::int64_t width, std::int64_t height,
                                          std::size_t frame_bytes, RowGroups groups) {
  const auto kind = kind_of(fourcc);
  if (!kind || width <= 0 || height <= 0 || width > wire::kMaxPixels || height > wire::kMaxPixels / width)
    return std::nullopt;
  const auto w = static_cast<std::size_t>(width), h = static_cast<std::size_t>(height);
  const std::size_t word = wire::word_bytes(kind->bits);
  const std::size_t chroma = kind->planes == Planes::k420 ? 2 * ((w + 1) / 2) * ((h + 1) / 2) : 0;
  if (frame_bytes == (w * h + chroma) * word) return StoredPixels{kind->bits, w * word};
  const std::size_t grouped = (w + 3) / 4 * 4;
  if (groups == RowGroups::kFourBytes && kind->planes == Planes::kGrey && kind->bits == 8 && frame_bytes == grouped * h)
    return StoredPixels{8, grouped};
  return std::nullopt;
}

bool is_usable(const StoredVideo& video) {
  const bool grows =
      std::adjacent_find(video.ticks.begin(), video.ticks.end(), std::greater_equal<>()) == video.ticks.end();
  const bool fits = video.bits == 8 ||
                    std::none_of(video.frames.begin(), video.frames.end(), [](std::size_t at) { return at % 2 != 0; });
  return !video.frames.empty() && video.ticks.size() == video.frames.size() && grows && fits;
}

std::optional<StoredVideo> stored_video(std::span<const std::byte> file) {
  if (auto avi = stored_avi(file)) return avi;
  return stored_matroska(file);
}

}  // namespace moiregauge::internal
