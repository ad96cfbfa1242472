// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/pictures/tiff_reader.h"

#include <array>
#include <cstdarg>
#include <cstdio>
#include <vector>

#include <fmt/format.h>
#include <tiffio.h>

#include "moiregauge/image/luma_of_colour.h"
#include "moiregauge/io/pictures/exif_orientation.h"
#include "moiregauge/io/pictures/tiff_page.h"

namespace moiregauge::internal {

struct TiffStack::State {
  TIFF* tiff = nullptr;
  std::string problem;
  std::shared_ptr<const MappedFile> file;  // null: pages are copied
};

namespace {

int note_tiff_error(TIFF* /*tiff*/, void* state, const char* /*module*/, const char* format, va_list values) {
  std::array<char, 256> text{};
  static_cast<void>(std::vsnprintf(text.data(), text.size(), format, values));
  static_cast<std::string*>(state)->assign(text.data());
  return 1;
}
int ignore_tiff_warning(TIFF* /*tiff*/, void* /*state*/, const char* /*module*/, const char* /*format*/,
                        va_list /*values*/) {
  return 1;
}

template <typename Grey>
bool read_tiff_rows(TIFF* tiff, const TiffPage& head, Image<Grey>& image) {
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

tl::expected<std::shared_ptr<TiffStack>, InputError> TiffStack::open(const std::string& path, std::int64_t max_pixels) {
  std::shared_ptr<TiffStack> stack(new TiffStack);
  stack->path_ = path;
  stack->max_pixels_ = max_pixels;
  TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
  TIFFOpenOptionsSetErrorHandlerExtR(options, &note_tiff_error, &stack->state_->problem);
  TIFFOpenOptionsSetWarningHandlerExtR(options, &ignore_tiff_warning, nullptr);
  // Bytes: a strip of the largest image as 16-bit colour. Tables of strips and compressed rows need less.
  TIFFOpenOptionsSetMaxSingleMemAlloc(options, static_cast<tmsize_t>(8 * max_pixels + (1 << 24)));
  stack->state_->tiff = TIFFOpenExt(path.c_str(), "rm", options);  // m: without a mapping of libtiff's own
  TIFFOpenOptionsFree(options);
  if (stack->state_->tiff == nullptr) {
    return tl::unexpected(InputError{
        InputErrorKind::kDamaged, fmt::format("the TIFF file cannot be read: {}: {}", path, stack->state_->problem)});
  }
  stack->pages_ = static_cast<long>(TIFFNumberOfDirectories(stack->state_->tiff));
  stack->state_->file = MappedFile::open(path);
  return stack;
}

bool TiffStack::show_in_place(Picture& picture) {
  const auto& file = state_->file;
  if (!file || !file->is_whole()) return false;
  const TiffPage head = page_at_hand(state_->tiff);
  const auto begin = place_of_rows(state_->tiff, head, file->bytes().size());
  if (!begin) return false;
  const auto show = [&]<typename Grey>(const Grey* pixels) {
    const int width = static_cast<int>(head.width);
    picture.in_place = ImageView<Grey>{pixels, width, static_cast<int>(head.height), width};
  };
  const std::byte* pixels = file->bytes().data() + *begin;
  if (head.word_bits == 8)
    show(reinterpret_cast<const std::uint8_t*>(pixels));
  else
    show(reinterpret_cast<const std::uint16_t*>(pixels));
  picture.file = file;
  return true;
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
  if (!there) return failure(InputErrorKind::kDamaged, "the image is damaged", state_->problem);
  const TiffPage head = page_at_hand(tiff);
  if (auto problem = size_problem(path_, head.width, head.height, max_pixels_)) return tl::unexpected(*problem);
  if (const std::string problem = problem_with(head); !problem.empty()) {
    return failure(InputErrorKind::kUnsupported, "this kind of TIFF is not supported", problem);
  }
  Picture picture{{}, significant_bits(head), 0, "tiff"};
  if (show_in_place(picture)) return picture;
  bool read = false;
  if (head.word_bits == 8)
    read = read_tiff_rows(tiff, head, picture.grey.emplace<0>());
  else
    read = read_tiff_rows(tiff, head, picture.grey.emplace<1>());
  if (!read) return failure(InputErrorKind::kDamaged, "the image is damaged", state_->problem);
  turn(picture, *rotation_of_orientation(head.orientation));
  return picture;
}

}  // namespace moiregauge::internal
