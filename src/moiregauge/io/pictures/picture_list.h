// SPDX-License-Identifier: Apache-2.0
// Lists the files of an image folder or a printf pattern in their order.
#pragma once

#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/run/frame_source.h"

namespace moiregauge::internal {

// One position in a sequence of images.
struct ListedPicture {
  std::string path;
  std::string problem;  // reason why there is no image, e.g. "a FIFO"; empty: a plain file
};

struct PictureList {
  std::vector<ListedPicture> pictures;
  std::string note;  // about numbers that do not count frames; usually empty
};

// Lists the images of a folder by file extension, in natural order. If there is none, lists those of its `frames/`.
// If the names contain a number, each missing number is a position with a problem, so later frames keep their numbers.
// A regular stride (0, 10, 20) is one frame per step. Hidden files are excluded.
// Returns an empty list if there is no image.
[[nodiscard]] tl::expected<PictureList, InputError> list_pictures(const std::string& folder);

// Lists the files of "shots/img_%04d.png" from the lowest existing number to the highest, missing ones included.
[[nodiscard]] tl::expected<PictureList, InputError> list_pictures_of_pattern(const std::string& pattern);

// Returns the paths of the images that exist.
[[nodiscard]] std::vector<std::string> existing_files(const PictureList& list);

// Returns the images that exist in a folder, without frame numbers.
[[nodiscard]] tl::expected<std::vector<std::string>, InputError> pictures_in_folder(const std::string& folder);

}  // namespace moiregauge::internal
