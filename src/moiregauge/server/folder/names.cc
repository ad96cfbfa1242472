// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/folder/names.h"

#include <algorithm>
#include <array>

namespace moiregauge::internal {

bool has_extension(std::string_view name, std::span<const std::string_view> list) {
  const auto dot = name.rfind('.');
  if (dot == std::string_view::npos) return false;
  std::string end(name.substr(dot + 1));
  std::ranges::transform(end, end.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return std::ranges::find(list, end) != list.end();
}

bool has_video_extension(std::string_view name) {
  constexpr std::array<std::string_view, 14> kList = {"mp4", "mov",  "m4v", "mkv", "webm", "avi",  "ts",
                                                      "mts", "m2ts", "y4m", "3gp", "mpg",  "mpeg", "mxf"};
  return has_extension(name, kList);
}

bool has_image_extension(std::string_view name) {
  constexpr std::array<std::string_view, 5> kList = {"png", "jpg", "jpeg", "tif", "tiff"};
  return has_extension(name, kList);
}

std::string without_picture_extension(const std::string& path) {
  return has_video_extension(path) || has_image_extension(path) ? path.substr(0, path.rfind('.')) : path;
}

}  // namespace moiregauge::internal
