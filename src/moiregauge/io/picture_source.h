// SPDX-License-Identifier: Apache-2.0
// Folders of pictures, numbered pictures, single pictures and TIFF stacks as a FrameSource.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "moiregauge/run/frame_source.h"

namespace moiregauge {

// All pictures have the size and depth of the first; one of another size ends the input there (kDamaged). One that
// cannot be read becomes a damaged frame of even grey, so that the frames after it keep their numbers.
// From the second picture on they are read ahead, as InputOptions::threads says.
// fails      kUnreadable (no such place, no picture in it), kUnsupported, kDamaged (the first picture cannot be read)
[[nodiscard]] tl::expected<std::unique_ptr<FrameSource>, InputError> open_pictures(const std::string& path,
                                                                                   const InputOptions& options);

// The files an INPUT of any kind consists of, in order: the pictures of a folder or pattern, else the one file.
// fails      kUnreadable
[[nodiscard]] tl::expected<std::vector<std::string>, InputError> files_of_input(const std::string& path,
                                                                                const InputOptions& options);

}  // namespace moiregauge
