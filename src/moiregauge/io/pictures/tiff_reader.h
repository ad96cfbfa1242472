// SPDX-License-Identifier: Apache-2.0
// Reads TIFF files, one image per page.
#pragma once

#include <memory>
#include <string>

#include <tl/expected.hpp>

#include "moiregauge/io/pictures/picture.h"

namespace moiregauge::internal {

// Supports grey or RGB pages of 8 or 16 bits, in strips, with any compression of libtiff. White-is-zero becomes
// black-is-zero, and a page's orientation is applied. Reading pages in order is fast, random access slower.
// An uncompressed grey page with contiguous strips is not copied: its image is a view into the mapped file.
class TiffStack {
 public:
  [[nodiscard]] static tl::expected<std::shared_ptr<TiffStack>, InputError> open(
      const std::string& path, std::int64_t max_pixels = InputOptions{}.max_pixels);
  ~TiffStack();
  TiffStack(const TiffStack&) = delete;
  TiffStack& operator=(const TiffStack&) = delete;
  [[nodiscard]] long pages() const { return pages_; }
  // Fails: kUnsupported (tiles, other depths, palettes, too many pixels, mirrored), kDamaged.
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
