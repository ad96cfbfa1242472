// SPDX-License-Identifier: Apache-2.0
// TIFF files, of which the pages are pictures.
#pragma once

#include <memory>
#include <string>

#include <tl/expected.hpp>

#include "moiregauge/io/pictures/picture.h"

namespace moiregauge::internal {

// Grey or RGB pages of 8 or 16 bits, in strips, any compression libtiff knows. White-is-zero pages are turned to
// black-is-zero; a page's orientation is applied. Pages are cheap in order, slower at random. An uncompressed grey page
// of which the strips follow one another is not read at all: its picture is a window on the file (lies_in_place).
class TiffStack {
 public:
  [[nodiscard]] static tl::expected<std::shared_ptr<TiffStack>, InputError> open(
      const std::string& path, std::int64_t max_pixels = InputOptions{}.max_pixels);
  ~TiffStack();
  TiffStack(const TiffStack&) = delete;
  TiffStack& operator=(const TiffStack&) = delete;
  [[nodiscard]] long pages() const { return pages_; }
  // fails      kUnsupported (tiles, other depths, palettes, too many pixels, mirrored), kDamaged
  [[nodiscard]] PictureOrError read(long page);

 private:
  struct State;
  TiffStack();
  [[nodiscard]] bool show_in_place(Picture& picture);
  std::unique_ptr<State> state_;
  std::string path_;
  std::int64_t max_pixels_ = 0;
  long pages_ = 0;
};

}  // namespace moiregauge::internal
