// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/pictures/png_reader.h"

#include <algorithm>
#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <memory>
#include <vector>

#include <fmt/format.h>
#include <png.h>

#include "moiregauge/base/plain_file.h"
#include "moiregauge/image/luma_of_colour.h"

namespace moiregauge::internal {
namespace {

// libpng reports errors by longjmp. Objects with destructors are here, outside the functions that it leaves.
struct PngFile {
  std::FILE* file = nullptr;
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::vector<unsigned char> samples;
  std::vector<png_bytep> rows;
  std::string problem;
  PngFile() = default;
  PngFile(const PngFile&) = delete;
  PngFile& operator=(const PngFile&) = delete;
  ~PngFile() {
    if (png != nullptr) png_destroy_read_struct(&png, &info, nullptr);
    if (file != nullptr) std::fclose(file);
  }
};

void note_png_error(png_structp png, png_const_charp text) {
  static_cast<PngFile*>(png_get_error_ptr(png))->problem = text;
  png_longjmp(png, 1);
}
void ignore_png_warning(png_structp /*png*/, png_const_charp /*text*/) {}

struct PngHead {
  png_uint_32 width = 0;
  png_uint_32 height = 0;
  int bits = 8;       // significant bits
  int word_bits = 8;  // stored bits: 8 or 16
  int channels = 1;   // 1 or 3, after the conversions below
  Tone tone;
};

// Returns the stated tone curve (PNG 11.3.2: sRGB, gAMA), or the usual one: sRGB for 8 bits, linear for 16.
Tone tone_of(PngFile& in, int word_bits) {
  int intent = 0;
  double file_gamma = 0.0;
  if (png_get_sRGB(in.png, in.info, &intent) != 0) return {{.kind = ToneCurve::Kind::kSrgb}, ToneSource::kTag};
  if (png_get_gAMA(in.png, in.info, &file_gamma) != 0 && file_gamma > 0.2 && file_gamma < 5.0) {
    if (std::abs(file_gamma - 1.0) < 0.005) return {{}, ToneSource::kTag};
    if (std::abs(file_gamma - 0.45455) < 0.0005) return {{.kind = ToneCurve::Kind::kSrgb}, ToneSource::kTag};
    return {{.kind = ToneCurve::Kind::kGamma, .gamma = 1.0 / file_gamma}, ToneSource::kTag};
  }
  return {{.kind = word_bits == 8 ? ToneCurve::Kind::kSrgb : ToneCurve::Kind::kLinear}, ToneSource::kAssumed};
}

// Returns the number of significant bits of a 16-bit file.
int significant_bits(PngFile& in) {
  png_color_8p sig = nullptr;
  if (png_get_sBIT(in.png, in.info, &sig) == 0) return 16;
  const bool colour = (png_get_color_type(in.png, in.info) & PNG_COLOR_MASK_COLOR) != 0;
  const int bits = colour ? std::max({sig->red, sig->green, sig->blue}) : sig->gray;
  return bits >= 9 && bits <= 16 ? bits : 16;
}

// Reads the size only, because libpng allocates a row before it can report the row's width.
bool read_png_size(PngFile& in, PngHead& head) {
  if (setjmp(png_jmpbuf(in.png)) != 0) return false;
  png_init_io(in.png, in.file);
  png_set_user_limits(in.png, 0x7fffffffU, 0x7fffffffU);  // the limit on pixels is checked later
  png_set_chunk_cache_max(in.png, 100);                   // ancillary chunks such as texts, which are not used
  png_set_chunk_malloc_max(in.png, 1U << 23);             // bytes that a compressed text may expand to
  png_read_info(in.png, in.info);
  head.width = png_get_image_width(in.png, in.info);
  head.height = png_get_image_height(in.png, in.info);
  return true;
}

bool read_png_head(PngFile& in, PngHead& head) {
  if (setjmp(png_jmpbuf(in.png)) != 0) return false;
  const int type = png_get_color_type(in.png, in.info);
  head.word_bits = png_get_bit_depth(in.png, in.info) == 16 ? 16 : 8;
  head.channels = (type & PNG_COLOR_MASK_COLOR) != 0 ? 3 : 1;
  if (type == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(in.png);
  if (type == PNG_COLOR_TYPE_GRAY) png_set_expand_gray_1_2_4_to_8(in.png);
  png_set_strip_alpha(in.png);
  head.bits = head.word_bits == 16 ? significant_bits(in) : 8;
  head.tone = tone_of(in, head.word_bits);
  if (head.word_bits == 16) png_set_swap(in.png);  // PNG is big-endian, this machine is not
  png_set_interlace_handling(in.png);
  png_read_update_info(in.png, in.info);
  return true;
}

bool read_png_rows(PngFile& in) {
  if (setjmp(png_jmpbuf(in.png)) != 0) return false;
  png_read_image(in.png, in.rows.data());
  png_read_end(in.png, nullptr);
  return true;
}

template <typename Grey>
Image<Grey> grey_from(const PngFile& in, const PngHead& head) {
  Image<Grey> image(static_cast<int>(head.width), static_cast<int>(head.height));
  unsigned brightest = 0;
  for (int y = 0; y < image.height(); ++y) {
    const auto* from = reinterpret_cast<const Grey*>(in.rows[static_cast<std::size_t>(y)]);
    for (Grey& grey : image.row(y)) {
      grey = head.channels == 3 ? luma_of_colour<Grey>(from[0], from[1], from[2]) : from[0];
      brightest = std::max<unsigned>(brightest, grey);
      from += head.channels;
    }
  }
  if (brightest < 1U << head.bits) return image;
  for (int y = 0; y < image.height(); ++y) {
    for (Grey& grey : image.row(y)) grey = static_cast<Grey>(grey >> (head.word_bits - head.bits));
  }
  return image;
}

}  // namespace

PictureOrError read_png(const std::string& path, std::int64_t max_pixels) {
  PngFile in;
  auto file = open_plain_file(path);
  if (!file)
    return input_failure(InputErrorKind::kUnreadable,
                         fmt::format("the image cannot be opened: {}: {}", path, file.error()));
  in.file = file->release();
  in.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &in, &note_png_error, &ignore_png_warning);
  in.info = in.png == nullptr ? nullptr : png_create_info_struct(in.png);
  if (in.info == nullptr)
    return input_failure(InputErrorKind::kUnreadable,
                         fmt::format("there is not enough memory for the image: {}: free memory", path));
  PngHead head;
  const auto unreadable = [&] {
    return input_failure(InputErrorKind::kDamaged,
                         fmt::format("the PNG file cannot be read: {}: {}", path, in.problem));
  };
  if (!read_png_size(in, head)) return unreadable();
  if (auto problem = size_problem(path, head.width, head.height, max_pixels)) return tl::unexpected(*problem);
  if (!read_png_head(in, head)) return unreadable();
  const std::size_t row_bytes = png_get_rowbytes(in.png, in.info);
  in.samples.resize(row_bytes * head.height);
  for (std::size_t y = 0; y < head.height; ++y) in.rows.push_back(in.samples.data() + y * row_bytes);
  if (!read_png_rows(in)) {
    return input_failure(InputErrorKind::kDamaged, fmt::format("the image is damaged: {}: {}", path, in.problem));
  }
  Picture picture{{}, head.bits, 0, "png"};
  picture.tone = head.tone;
  if (head.word_bits == 16)
    picture.grey = grey_from<std::uint16_t>(in, head);
  else
    picture.grey = grey_from<std::uint8_t>(in, head);
  return picture;
}

}  // namespace moiregauge::internal
