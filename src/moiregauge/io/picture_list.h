// SPDX-License-Identifier: Apache-2.0
// Which files a folder of pictures, or a printf pattern, stands for, in which order.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/run/frame_source.h"

namespace moiregauge {

// The order people expect: runs of digits by their value, so frame9 comes before frame10.
[[nodiscard]] bool comes_before(std::string_view a, std::string_view b);

// The pictures of a folder by their names' endings, in natural order; if it holds none, those of its `frames/`.
// Hidden files are left out. Empty when there is none.
[[nodiscard]] tl::expected<std::vector<std::string>, InputError> pictures_in_folder(const std::string& folder);

// The files of "shots/img_%04d.png": from the lowest number that exists to the highest. A missing number between
// them stays in the list, so the frames after it keep their numbers.
[[nodiscard]] tl::expected<std::vector<std::string>, InputError> pictures_of_pattern(const std::string& pattern);

}  // namespace moiregauge
