// SPDX-License-Identifier: Apache-2.0
// Tags of one TIFF page. Used by the reader of stacks only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include <tiffio.h>

namespace moiregauge::internal {

struct TiffPage {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint16_t word_bits = 1;
  std::uint16_t samples = 1;
  std::uint16_t photometric = 0;
  std::uint16_t planar = PLANARCONFIG_CONTIG;
  std::uint16_t format = SAMPLEFORMAT_UINT;
  std::uint16_t orientation = 1;
  std::uint16_t brightest = 0;  // stated largest value; 0: not stated
  bool tiled = false;
};

[[nodiscard]] TiffPage page_at_hand(TIFF* tiff);

// Returns the reason why this page cannot be read, or an empty text.
[[nodiscard]] std::string problem_with(const TiffPage& page);

// Returns the number of significant bits. 16-bit words with a smaller stated maximum have fewer bits.
[[nodiscard]] int significant_bits(const TiffPage& page);

// Returns the file offset of the pixels if they can be used in place, otherwise nothing. The page must be uncompressed
// grey and upright. Black must be zero, words must have this machine's byte order, and strips must be contiguous and
// within file_bytes.
[[nodiscard]] std::optional<std::size_t> place_of_rows(TIFF* tiff, const TiffPage& page, std::size_t file_bytes);

}  // namespace moiregauge::internal
