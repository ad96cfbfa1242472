// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/pictures/jpeg_reader.h"

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstdio>

#include <fmt/format.h>
#include <jpeglib.h>

#include "moiregauge/base/plain_file.h"
#include "moiregauge/image/luma_of_colour.h"
#include "moiregauge/io/pictures/exif_orientation.h"

namespace moiregauge::internal {
namespace {

// libjpeg reports errors by longjmp. Objects with destructors are here, outside the functions that it leaves.
struct JpegFile {
  std::FILE* file = nullptr;
  jpeg_decompress_struct jpeg{};
  jpeg_error_mgr errors{};
  std::jmp_buf out_of_here{};
  bool created = false;
  std::array<char, JMSG_LENGTH_MAX> problem{};
  std::vector<std::uint8_t> row;
  Image<std::uint8_t> image;
  Quantiser quantiser;
  JpegFile() = default;
  JpegFile(const JpegFile&) = delete;
  JpegFile& operator=(const JpegFile&) = delete;
  ~JpegFile() {
    if (created) jpeg_destroy_decompress(&jpeg);
    if (file != nullptr) std::fclose(file);
  }
};

void leave(j_common_ptr jpeg) {
  auto* in = static_cast<JpegFile*>(jpeg->client_data);
  jpeg->err->format_message(jpeg, in->problem.data());
  std::longjmp(in->out_of_here, 1);
}
// Treats warnings of libjpeg ("premature end", "corrupt data") as errors, because libjpeg fills in such pixels.
void note_warning(j_common_ptr jpeg, int level) {
  if (level < 0) leave(jpeg);
}

bool read_jpeg_head(JpegFile& in) {
  in.jpeg.err = jpeg_std_error(&in.errors);
  in.errors.error_exit = &leave;
  in.errors.emit_message = &note_warning;
  in.jpeg.client_data = &in;
  if (setjmp(in.out_of_here) != 0) return false;
  jpeg_create_decompress(&in.jpeg);
  in.created = true;
  jpeg_stdio_src(&in.jpeg, in.file);
  jpeg_save_markers(&in.jpeg, JPEG_APP0 + 1, 0xffff);
  jpeg_read_header(&in.jpeg, TRUE);
  return true;
}

// Returns the quantiser of the luma table. Without a table it is unknown, but the image is still lossy.
Quantiser quantiser_of(const JpegFile& in) {
  if (in.jpeg.num_components < 1 || in.jpeg.comp_info == nullptr) return {kUnknownStep, false};
  const int number = in.jpeg.comp_info[0].quant_tbl_no;
  if (number < 0 || number >= NUM_QUANT_TBLS || in.jpeg.quant_tbl_ptrs[number] == nullptr) return {kUnknownStep, false};
  std::array<std::uint16_t, DCTSIZE2> zigzag{};
  std::size_t k = 0;
  for (int diagonal = 0; diagonal < 2 * DCTSIZE - 1; ++diagonal) {  // libjpeg stores the table row by row
    for (int v = std::max(0, diagonal - DCTSIZE + 1); v <= std::min(diagonal, DCTSIZE - 1); ++v)
      zigzag[k++] = in.jpeg.quant_tbl_ptrs[number]->quantval[v * DCTSIZE + diagonal - v];
  }
  return {step_of_jpeg_table(zigzag), false};
}

// Reads luma: the stored first component of grey and YCbCr images, or computed from RGB.
bool read_jpeg_rows(JpegFile& in) {
  if (setjmp(in.out_of_here) != 0) return false;
  const bool colour = in.jpeg.jpeg_color_space == JCS_RGB;
  in.jpeg.out_color_space = colour ? JCS_RGB : JCS_GRAYSCALE;
  in.jpeg.dct_method = JDCT_ISLOW;
  jpeg_start_decompress(&in.jpeg);
  while (in.jpeg.output_scanline < in.jpeg.output_height) {
    const auto out = in.image.row(static_cast<int>(in.jpeg.output_scanline));
    JSAMPROW row = colour ? in.row.data() : out.data();
    jpeg_read_scanlines(&in.jpeg, &row, 1);
    for (std::size_t x = 0; colour && x < out.size(); ++x) {
      out[x] = luma_of_colour<std::uint8_t>(row[3 * x], row[3 * x + 1], row[3 * x + 2]);
    }
  }
  in.quantiser = quantiser_of(in);
  jpeg_finish_decompress(&in.jpeg);
  return true;
}

int orientation_of(const JpegFile& in) {
  for (const auto* marker = in.jpeg.marker_list; marker != nullptr; marker = marker->next) {
    const int orientation = exif_orientation({marker->data, marker->data_length});
    if (orientation != 1) return orientation;
  }
  return 1;
}

std::string start_of(const JpegFile& in) {
  for (const auto* marker = in.jpeg.marker_list; marker != nullptr; marker = marker->next) {
    std::string start = exif_start_utc({marker->data, marker->data_length});
    if (!start.empty()) return start;
  }
  return {};
}

}  // namespace

PictureOrError read_jpeg(const std::string& path, std::int64_t max_pixels) {
  JpegFile in;
  auto file = open_plain_file(path);
  if (!file)
    return input_failure(InputErrorKind::kUnreadable,
                         fmt::format("the image cannot be opened: {}: {}", path, file.error()));
  in.file = file->release();
  if (!read_jpeg_head(in)) {
    return input_failure(InputErrorKind::kDamaged,
                         fmt::format("the JPEG file cannot be read: {}: {}", path, in.problem.data()));
  }
  if (in.jpeg.jpeg_color_space == JCS_CMYK || in.jpeg.jpeg_color_space == JCS_YCCK || in.jpeg.data_precision != 8) {
    return input_failure(InputErrorKind::kUnsupported,
                         fmt::format("the colours are not supported: {}: store it as grey or YCbCr, 8 bits", path));
  }
  const auto rotation = rotation_of_orientation(orientation_of(in));
  if (!rotation)
    return input_failure(InputErrorKind::kUnsupported,
                         fmt::format("the image is mirrored: {}: store it without mirroring", path));
  if (auto problem = size_problem(path, in.jpeg.image_width, in.jpeg.image_height, max_pixels))
    return tl::unexpected(*problem);
  in.image = Image<std::uint8_t>(static_cast<int>(in.jpeg.image_width), static_cast<int>(in.jpeg.image_height));
  in.row.resize(std::size_t{3} * in.jpeg.image_width);
  if (!read_jpeg_rows(in)) {
    return input_failure(InputErrorKind::kDamaged,
                         fmt::format("the image is damaged: {}: {}", path, in.problem.data()));
  }
  Picture picture{std::move(in.image), 8, 0, "jpeg", in.quantiser};
  picture.tone.curve.kind = ToneCurve::Kind::kSrgb;  // usual for JPEG files (ISO/IEC 10918-5)
  picture.start_utc = start_of(in);
  turn(picture, *rotation);
  return picture;
}

}  // namespace moiregauge::internal
