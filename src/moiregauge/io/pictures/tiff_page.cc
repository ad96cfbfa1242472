// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/pictures/tiff_page.h"

#include <fmt/format.h>

#include "moiregauge/io/pictures/exif_orientation.h"
#include "moiregauge/io/pictures/picture.h"

namespace moiregauge::internal {
namespace {

// Largest number of samples per pixel: colour with transparency. A row is read at once, so a damaged tag of 65535
// samples would allocate gigabytes.
constexpr int kMaxSamples = 4;

}  // namespace

TiffPage page_at_hand(TIFF* tiff) {
  TiffPage page;
  TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &page.width);
  TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &page.height);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_BITSPERSAMPLE, &page.word_bits);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &page.samples);
  TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &page.photometric);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_PLANARCONFIG, &page.planar);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLEFORMAT, &page.format);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_ORIENTATION, &page.orientation);
  TIFFGetField(tiff, TIFFTAG_MAXSAMPLEVALUE, &page.brightest);
  page.tiled = TIFFIsTiled(tiff) != 0;
  return page;
}

std::string problem_with(const TiffPage& page) {
  const bool grey = page.photometric == PHOTOMETRIC_MINISBLACK || page.photometric == PHOTOMETRIC_MINISWHITE;
  const bool colour = page.photometric == PHOTOMETRIC_RGB && page.samples >= 3;
  if (!grey && !colour) return "store it as grey or RGB";
  if (page.samples > kMaxSamples)
    return fmt::format("it has {} samples per pixel, store it as grey or RGB", page.samples);
  if (page.word_bits != 8 && page.word_bits != 16)
    return fmt::format("it has {} bits per sample, store 8 or 16", page.word_bits);
  if (page.format != SAMPLEFORMAT_UINT) return "store unsigned whole numbers";
  if (page.planar != PLANARCONFIG_CONTIG && page.samples > 1)
    return "store the colours of each pixel together (contiguous)";
  if (page.tiled) return "store it in strips, not tiles";
  if (!rotation_of_orientation(page.orientation)) return "it is mirrored, store it without mirroring";
  return {};
}

int significant_bits(const TiffPage& page) {
  int bits = page.word_bits;
  while (bits > 9 && page.brightest > 0 && page.brightest < 1U << static_cast<unsigned>(bits - 1)) --bits;
  return bits;
}

std::optional<std::size_t> place_of_rows(TIFF* tiff, const TiffPage& page, std::size_t file_bytes) {
  std::uint16_t compression = COMPRESSION_NONE, fill_order = FILLORDER_MSB2LSB;
  TIFFGetFieldDefaulted(tiff, TIFFTAG_COMPRESSION, &compression);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_FILLORDER, &fill_order);
  const bool words = page.word_bits == 16;
  if (compression != COMPRESSION_NONE || fill_order != FILLORDER_MSB2LSB || page.samples != 1) return std::nullopt;
  if (page.photometric != PHOTOMETRIC_MINISBLACK || rotation_of_orientation(page.orientation) != 0) return std::nullopt;
  if (words && TIFFIsByteSwapped(tiff) != 0) return std::nullopt;
  const std::uint64_t bytes = std::uint64_t{page.width} * page.height * (words ? 2U : 1U);
  const std::uint64_t begin = TIFFGetStrileOffset(tiff, 0);
  std::uint64_t end = begin;
  for (std::uint32_t strip = 0; strip < TIFFNumberOfStrips(tiff); ++strip) {
    if (TIFFGetStrileOffset(tiff, strip) != end) return std::nullopt;
    const std::uint64_t size = TIFFGetStrileByteCount(tiff, strip);
    if (size == 0 || size > file_bytes || end > file_bytes - size) return std::nullopt;
    end += size;
  }
  if (end - begin != bytes || (words && begin % 2 != 0)) return std::nullopt;
  return static_cast<std::size_t>(begin);
}

}  // namespace moiregauge::internal
