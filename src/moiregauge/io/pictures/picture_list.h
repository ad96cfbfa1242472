// SPDX-License-Identifier: Apache-2.0
// The files that a folder of pictures, or a printf pattern, consists of, in their order.
#pragma once

#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/run/frame_source.h"

namespace moiregauge::internal {

// One place in a sequence of pictures.
struct ListedPicture {
  std::string path;
  std::string problem;  // why there is no picture at this place, e.g. "a FIFO"; empty: there is a plain file
};

struct PictureList {
  std::vector<ListedPicture> pictures;
  std::string note;  // on numbers that do not count frames; empty: there is nothing to say
};

// Lists the pictures of a folder by their names' endings, in natural order; if it holds none, those of its `frames/`.
// If the names carry a number, each missing one is a place with a problem, so later frames keep their numbers; a
// regular stride of the numbers (0, 10, 20) is the step from frame to frame. Hidden files are excluded.
// Empty when there is no picture.
[[nodiscard]] tl::expected<PictureList, InputError> list_pictures(const std::string& folder);

// Lists the files of "shots/img_%04d.png", from the lowest number that exists to the highest, missing ones included.
[[nodiscard]] tl::expected<PictureList, InputError> list_pictures_of_pattern(const std::string& pattern);

// Returns the paths of the pictures that exist.
[[nodiscard]] std::vector<std::string> existing_files(const PictureList& list);

// Returns the pictures that exist in a folder, without frame numbers.
[[nodiscard]] tl::expected<std::vector<std::string>, InputError> pictures_in_folder(const std::string& folder);

}  // namespace moiregauge::internal
