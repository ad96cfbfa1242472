// SPDX-License-Identifier: Apache-2.0
// Finds the images of uncompressed videos in the file. Supports the simplest layouts only, and checks them completely.
// All other files need the decoder.
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
  std::size_t row_bytes = 0;        // distance of luma rows
  std::vector<std::size_t> frames;  // file offset of each frame's first row
  std::vector<std::int64_t> ticks;  // time stamps, increasing, one per frame
  std::int64_t tick_numerator = 0;  // s per tick
  std::int64_t tick_denominator = 1;
};

// Return the layout. All its bytes are inside `file`. They read the headers of all frames, not the pixels.
[[nodiscard]] std::optional<StoredVideo> stored_avi(std::span<const std::byte> file);
[[nodiscard]] std::optional<StoredVideo> stored_matroska(std::span<const std::byte> file);
[[nodiscard]] std::optional<StoredVideo> stored_video(std::span<const std::byte> file);  // either kind

// Layout of images of one FourCC: the luma plane first. Rows are packed, or padded to 4 bytes for 8-bit grey in AVI.
struct StoredPixels {
  int bits = 8;
  std::size_t row_bytes = 0;
};
enum class RowGroups { kPacked, kFourBytes };

// Returns the layout. `fourcc`: four bytes in file order, the first one lowest. `frame_bytes`: size of an image with
// chroma.
[[nodiscard]] std::optional<StoredPixels> stored_pixels(std::uint32_t fourcc, std::int64_t width, std::int64_t height,
                                                        std::size_t frame_bytes, RowGroups groups);

// Returns true if frames and times are consistent. 16-bit images must start at even offsets.
[[nodiscard]] bool is_usable(const StoredVideo& video);

}  // namespace moiregauge::internal
