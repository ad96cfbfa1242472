// SPDX-License-Identifier: Apache-2.0
// One picture read from a file, as displayed, in grey levels as stored.
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
  std::variant<Image<std::uint8_t>, Image<std::uint16_t>> grey;  // empty where the file shows it in place
  int bits = 8;           // 8 in 8-bit words, 9 to 16 in the low bits of 16-bit words
  int rotation_deg = 0;   // clockwise, already applied
  std::string codec;      // "png", "jpeg", "tiff"
  Quantiser quantiser{};  // of a lossy one
  Tone tone{};            // as the file says, or as is usual for its kind
  // A picture that lies in its file as it was is not copied: a window on the file's pages, which `file` holds.
  std::optional<LumaView> in_place = std::nullopt;
  std::shared_ptr<const MappedFile> file = nullptr;
};

using PictureOrError = tl::expected<Picture, InputError>;

// A header may promise any size, and a file of a megabyte unpack to gigabytes: readers ask this before they take
// memory.
[[nodiscard]] inline std::optional<InputError> size_problem(const std::string& path, std::int64_t width,
                                                            std::int64_t height, std::int64_t max_pixels) {
  if (width <= 0 || height <= 0) return InputError{InputErrorKind::kDamaged, "no pixels: " + path + ": copy it again"};
  if (width <= max_pixels && height <= max_pixels / width) return std::nullopt;
  return InputError{InputErrorKind::kUnsupported,
                    fmt::format("image {}x{} exceeds the limit of {:g} Mpx: {}: raise --max-pixels if it is right",
                                width, height, static_cast<double>(max_pixels) / 1e6, path)};
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

}  // namespace moiregauge::internal
