// SPDX-License-Identifier: Apache-2.0
// Videos that need no decoder: every picture lies in the file as it was, at a place of its own. Only the plainest
// layout is understood, and understood whole; of anything else the answer is nothing, and the decoder reads it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace moiregauge::internal {

struct StoredVideo {
  int width = 0;  // px
  int height = 0;
  int bits = 8;                     // 8 in bytes, more in little-endian words
  std::size_t row_bytes = 0;        // from one row of luma to the next
  std::vector<std::size_t> frames;  // where in the file the first row of each begins
  std::vector<std::int64_t> ticks;  // time stamps, growing; one per frame
  std::int64_t tick_numerator = 0;  // seconds per tick
  std::int64_t tick_denominator = 1;
};

// Every byte that the answer speaks of is inside `file`. Looks at the heads of all frames, not at their pixels.
[[nodiscard]] std::optional<StoredVideo> stored_avi(std::span<const std::byte> file);
[[nodiscard]] std::optional<StoredVideo> stored_matroska(std::span<const std::byte> file);
[[nodiscard]] std::optional<StoredVideo> stored_video(std::span<const std::byte> file);  // of either kind

// How pictures of a FourCC lie in memory: the luma plane first, rows packed or, of 8-bit grey in an AVI, in whole
// 4-byte groups.
struct StoredPixels {
  int bits = 8;
  std::size_t row_bytes = 0;
};
enum class RowGroups { kPacked, kFourBytes };

// fourcc: as four bytes in file order, first lowest. frame_bytes: of one whole picture, chroma included.
[[nodiscard]] std::optional<StoredPixels> stored_pixels(std::uint32_t fourcc, std::int64_t width, std::int64_t height,
                                                        std::size_t frame_bytes, RowGroups groups);

// Places of words must fit them: 16-bit pictures begin at even places.
[[nodiscard]] bool is_usable(const StoredVideo& video);

}  // namespace moiregauge::internal
