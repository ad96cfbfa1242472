// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/pictures/picture_file.h"

#include <array>
#include <cstdio>
#include <string_view>

#include <fmt/format.h>

#include "moiregauge/base/plain_file.h"
#include "moiregauge/io/pictures/jpeg_reader.h"
#include "moiregauge/io/pictures/png_reader.h"
#include "moiregauge/io/pictures/tiff_reader.h"

namespace moiregauge::internal {

using std::string_view_literals::operator""sv;

PictureKind picture_kind(const std::string& path) {
  const auto file = open_plain_file(path);
  std::array<char, 8> head{};
  if (!file) return PictureKind::kNone;
  const std::string_view bytes(head.data(), std::fread(head.data(), 1, head.size(), file->get()));
  if (bytes.starts_with("\x89PNG\r\n\x1a\n"sv)) return PictureKind::kPng;
  if (bytes.starts_with("\xff\xd8\xff"sv)) return PictureKind::kJpeg;
  if (bytes.starts_with("II*\0"sv) || bytes.starts_with("MM\0*"sv)) return PictureKind::kTiff;
  if (bytes.starts_with("II+\0"sv) || bytes.starts_with("MM\0+"sv)) return PictureKind::kTiff;
  return PictureKind::kNone;
}

PictureOrError read_picture(const std::string& path, std::int64_t max_pixels) {
  switch (picture_kind(path)) {
    case PictureKind::kPng:
      return read_png(path, max_pixels);
    case PictureKind::kJpeg:
      return read_jpeg(path, max_pixels);
    case PictureKind::kTiff:
      return TiffStack::open(path, max_pixels).and_then([](const auto& stack) { return stack->read(0); });
    case PictureKind::kNone:
      break;
  }
  if (const auto file = open_plain_file(path); !file)
    return input_failure(InputErrorKind::kUnreadable,
                         fmt::format("the image cannot be opened: {}: {}", path, file.error()));
  return tl::unexpected(InputError{InputErrorKind::kUnsupported,
                                   fmt::format("the file is not an image: {}: give PNG, TIFF or JPEG files", path)});
}

}  // namespace moiregauge::internal
