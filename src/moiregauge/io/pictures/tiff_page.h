// SPDX-License-Identifier: Apache-2.0
// What a page of a TIFF says about its picture. For the reader of stacks only.
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

// Why this page is none we read, or nothing.
[[nodiscard]] std::string problem_with(const TiffPage& page);

// 16-bit words that state a smaller largest value hold fewer bits.
[[nodiscard]] int significant_bits(const TiffPage& page);

// Where in the file the page's pixels begin, if they lie there row by row as they are: uncompressed grey, upright,
// black is zero, words as this machine has them, one strip behind the other and all of them inside file_bytes.
[[nodiscard]] std::optional<std::size_t> place_of_rows(TIFF* tiff, const TiffPage& page, std::size_t file_bytes);

}  // namespace moiregauge::internal
