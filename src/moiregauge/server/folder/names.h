// SPDX-License-Identifier: Apache-2.0
// Kinds of files by their extension.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace moiregauge::internal {

// Returns true if a name has one of the extensions, in any case.
[[nodiscard]] bool has_extension(std::string_view name, std::span<const std::string_view> list);
[[nodiscard]] bool has_video_extension(std::string_view name);
[[nodiscard]] bool has_image_extension(std::string_view name);
// Returns a path without the extension of a video or an image.
[[nodiscard]] std::string without_picture_extension(const std::string& path);

}  // namespace moiregauge::internal
