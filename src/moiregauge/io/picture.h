// SPDX-License-Identifier: Apache-2.0
// One picture read from a file, as displayed, in grey levels as stored.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include <tl/expected.hpp>

#include "moiregauge/image/image.h"
#include "moiregauge/image/quarter_turn.h"
#include "moiregauge/run/frame_source.h"
#include "moiregauge/run/mapped_file.h"

namespace moiregauge {

struct Picture {
  std::variant<Image<std::uint8_t>, Image<std::uint16_t>> grey;  // empty where the file shows it in place
  int bits = 8;          // 8 in 8-bit words, 9 to 16 in the low bits of 16-bit words
  int rotation_deg = 0;  // clockwise, already applied
  std::string codec;     // "png", "jpeg", "tiff"
  // A picture that lies in its file as it was is not copied: a window on the file's pages, which `file` holds.
  std::optional<LumaView> in_place = std::nullopt;
  std::shared_ptr<const MappedFile> file = nullptr;
};

using PictureOrError = tl::expected<Picture, InputError>;

// A header may promise any size; 2^28 pixels are 30 times the largest camera we know of.
inline constexpr std::int64_t kMostPixels = std::int64_t{1} << 28;

[[nodiscard]] inline bool is_size_allowed(std::int64_t width, std::int64_t height) {
  return width > 0 && height > 0 && width <= kMostPixels && height <= kMostPixels / width;
}

[[nodiscard]] inline LumaView view_of(const Picture& picture) {
  if (picture.in_place) return *picture.in_place;
  return std::visit([](const auto& image) { return LumaView(image.view()); }, picture.grey);
}

// Applies a rotation tag: quarters clockwise, in degrees. Not of a picture in place.
inline void turn(Picture& picture, int degrees) {
  if (degrees == 0) return;
  picture.rotation_deg = degrees;
  std::visit([degrees](auto& image) { image = turned_clockwise(image.view(), degrees); }, picture.grey);
}

}  // namespace moiregauge
