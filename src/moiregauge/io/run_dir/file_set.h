// SPDX-License-Identifier: Apache-2.0
// A folder of files that appears as a whole or not at all.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/base/output_error.h"

namespace moiregauge::internal {

using NamedBytes = std::pair<std::string, std::string>;  // name in the folder, content

enum class Existing {
  kRefuse,   // the folder must be new or empty
  kReplace,  // a folder is replaced if it holds nothing but files whose endings are among those now written
};

// Writes beside DIR under another name, brings it to the disk, and puts it in its place in one step.
// fails   (usage) where DIR is somebody else's; (not usage) where nothing can be written: nothing is left behind then
[[nodiscard]] tl::expected<void, OutputError> write_file_set(const std::string& dir,
                                                             const std::vector<NamedBytes>& files, Existing existing);

}  // namespace moiregauge::internal
