// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/tiff_reader.h"

#include <array>
#include <cstdarg>
#include <cstdio>
#include <vector>

#include <fmt/format.h>
#include <tiffio.h>

#include "moiregauge/image/luma_of_colour.h"
#include "moiregauge/io/exif_orientation.h"

namespace moiregauge {

struct TiffStack::State {
  TIFF* tiff = nullptr;
  std::string problem;
};

namespace {

struct PageHead {
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

int note_error(TIFF* /*tiff*/, void* state, const char* /*module*/, const char* format, va_list values) {
  std::array<char, 256> text{};
  static_cast<void>(std::vsnprintf(text.data(), text.size(), format, values));
  static_cast<std::string*>(state)->assign(text.data());
  return 1;
}
int ignore_warning(TIFF* /*tiff*/, void* /*state*/, const char* /*module*/, const char* /*format*/,
                   va_list /*values*/) {
  return 1;
}

PageHead head_of(TIFF* tiff) {
  PageHead head;
  TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &head.width);
  TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &head.height);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_BITSPERSAMPLE, &head.word_bits);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &head.samples);
  TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &head.photometric);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_PLANARCONFIG, &head.planar);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLEFORMAT, &head.format);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_ORIENTATION, &head.orientation);
  TIFFGetField(tiff, TIFFTAG_MAXSAMPLEVALUE, &head.brightest);
  head.tiled = TIFFIsTiled(tiff) != 0;
  return head;
}

// Why this page is none we read, or nothing.
std::string problem_with(const PageHead& head) {
  const bool grey = head.photometric == PHOTOMETRIC_MINISBLACK || head.photometric == PHOTOMETRIC_MINISWHITE;
  const bool colour = head.photometric == PHOTOMETRIC_RGB && head.samples >= 3;
  if (!is_size_allowed(head.width, head.height)) return "it must have 1 to 2^28 pixels";
  if (!grey && !colour) return "store it as grey or RGB";
  if (head.word_bits != 8 && head.word_bits != 16)
    return fmt::format("{} bits a sample; store 8 or 16", head.word_bits);
  if (head.format != SAMPLEFORMAT_UINT) return "store whole numbers without sign";
  if (head.planar != PLANARCONFIG_CONTIG && head.samples > 1) return "store the colours of a pixel together";
  if (head.tiled) return "store it in strips, not tiles";
  if (!rotation_of_orientation(head.orientation)) return "it is mirrored; store it unmirrored";
  return {};
}

// 16-bit words that state a smaller largest value hold fewer bits.
int significant_bits(const PageHead& head) {
  int bits = head.word_bits;
  while (bits > 9 && head.brightest > 0 && head.brightest < 1U << static_cast<unsigned>(bits - 1)) --bits;
  return bits;
}

template <typename Grey>
bool read_rows(TIFF* tiff, const PageHead& head, Image<Grey>& image) {
  image = Image<Grey>(static_cast<int>(head.width), static_cast<int>(head.height));
  const std::size_t row_bytes = static_cast<std::size_t>(TIFFScanlineSize(tiff));
  if (row_bytes < std::size_t{head.width} * head.samples * sizeof(Grey)) return false;
  std::vector<Grey> row((row_bytes + sizeof(Grey) - 1) / sizeof(Grey));
  const bool colour = head.photometric == PHOTOMETRIC_RGB;
  for (std::uint32_t y = 0; y < head.height; ++y) {
    if (TIFFReadScanline(tiff, row.data(), y, 0) < 0) return false;
    const Grey* from = row.data();
    for (Grey& grey : image.row(static_cast<int>(y))) {
      grey = colour ? luma_of_colour<Grey>(from[0], from[1], from[2]) : *from;
      if (head.photometric == PHOTOMETRIC_MINISWHITE) grey = static_cast<Grey>(~grey);
      from += head.samples;
    }
  }
  return true;
}

}  // namespace

TiffStack::TiffStack() : state_(std::make_unique<State>()) {}
TiffStack::~TiffStack() {
  if (state_->tiff != nullptr) TIFFClose(state_->tiff);
}

tl::expected<std::shared_ptr<TiffStack>, InputError> TiffStack::open(const std::string& path) {
  std::shared_ptr<TiffStack> stack(new TiffStack);
  stack->path_ = path;
  TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
  TIFFOpenOptionsSetErrorHandlerExtR(options, &note_error, &stack->state_->problem);
  TIFFOpenOptionsSetWarningHandlerExtR(options, &ignore_warning, nullptr);
  TIFFOpenOptionsSetMaxSingleMemAlloc(options, tmsize_t{1} << 31);
  stack->state_->tiff = TIFFOpenExt(path.c_str(), "r", options);
  TIFFOpenOptionsFree(options);
  if (stack->state_->tiff == nullptr) {
    return tl::unexpected(
        InputError{InputErrorKind::kDamaged, fmt::format("not a readable TIFF: {}: {}", path, stack->state_->problem)});
  }
  stack->pages_ = static_cast<long>(TIFFNumberOfDirectories(stack->state_->tiff));
  return stack;
}

PictureOrError TiffStack::read(long page) {
  TIFF* tiff = state_->tiff;
  state_->problem.clear();
  const auto failure = [&](InputErrorKind kind, const char* what, const std::string& why) {
    return tl::unexpected(InputError{kind, fmt::format("{}: {} page {}: {}", what, path_, page, why)});
  };
  const auto current = static_cast<long>(TIFFCurrentDirectory(tiff));
  const bool there = current == page || (current + 1 == page && TIFFReadDirectory(tiff) != 0) ||
                     TIFFSetDirectory(tiff, static_cast<tdir_t>(page)) != 0;
  if (!there) return failure(InputErrorKind::kDamaged, "damaged picture", state_->problem);
  const PageHead head = head_of(tiff);
  if (const std::string problem = problem_with(head); !problem.empty()) {
    return failure(InputErrorKind::kUnsupported, "unknown kind of TIFF", problem);
  }
  Picture picture{{}, significant_bits(head), 0, "tiff"};
  bool read = false;
  if (head.word_bits == 8)
    read = read_rows(tiff, head, picture.grey.emplace<0>());
  else
    read = read_rows(tiff, head, picture.grey.emplace<1>());
  if (!read) return failure(InputErrorKind::kDamaged, "damaged picture", state_->problem);
  turn(picture, *rotation_of_orientation(head.orientation));
  return picture;
}

}  // namespace moiregauge
