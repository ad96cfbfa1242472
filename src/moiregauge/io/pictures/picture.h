// SPDX-License-Identifier: Apache-2.0
// One image read from a file, as displayed, in grey levels as stored.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include <fmt/format.h>
#include <tl/expected.hpp>

#include "moiregauge/base/mapped_file.h"
#include "moiregauge/image/image.h"
#include "moiregauge/image/quarter_turn.h"
#include "moiregauge/run/frame_source.h"

namespace moiregauge::internal {

struct Picture {
  std::variant<Image<std::uint8_t>, Image<std::uint16_t>> grey;  // empty if `in_place` is set
  int bits = 8;             // 8 in 8-bit words, 9 to 16 in the low bits of 16-bit words
  int rotation_deg = 0;     // clockwise, already applied
  std::string codec;        // "png", "jpeg", "tiff"
  Quantiser quantiser{};    // for a lossy format
  Tone tone{};              // as tagged in the file, or usual for its format
  std::string start_utc{};  // as stated in the file; empty: not stated
  // View into the mapped file for uncompressed images, which are not copied. `file` owns the pages.
  std::optional<LumaView> in_place = std::nullopt;
  std::shared_ptr<const MappedFile> file = nullptr;
};

using PictureOrError = tl::expected<Picture, InputError>;

// Returns the reason why this size is refused, or nothing. Readers call it before they allocate memory, because a
// header may claim any size.
[[nodiscard]] inline std::optional<InputError> size_problem(const std::string& path, std::int64_t width,
                                                            std::int64_t height, std::int64_t max_pixels) {
  if (width <= 0 || height <= 0)
    return InputError{InputErrorKind::kDamaged, "the image has no pixels: " + path + ": copy it again"};
  if (width <= max_pixels && height <= max_pixels / width) return std::nullopt;
  return InputError{InputErrorKind::kUnsupported,
                    fmt::format("the image size {}x{} exceeds the limit of {:g} Mpx: {}: raise --max-pixels if the "
                                "size is correct",
                                width, height, static_cast<double>(max_pixels) / 1e6, path)};
}

[[nodiscard]] inline LumaView view_of(const Picture& picture) {
  if (picture.in_place) return *picture.in_place;
  return std::visit([](const auto& image) { return LumaView(image.view()); }, picture.grey);
}

// Applies a rotation tag, in degrees clockwise (a multiple of 90). Not for an image in place.
inline void turn(Picture& picture, int degrees) {
  if (degrees == 0) return;
  picture.rotation_deg = degrees;
  std::visit([degrees](auto& image) { image = turned_clockwise(image.view(), degrees); }, picture.grey);
}

}  // namespace moiregauge::internal
