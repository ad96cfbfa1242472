// SPDX-License-Identifier: Apache-2.0
// Folders of pictures, numbered pictures, single pictures and TIFF stacks as a FrameSource.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "moiregauge/run/frame_source.h"

namespace moiregauge::internal {

// Opens the pictures of a folder, a pattern, a TIFF stack or one file. All have the size and depth of the first one
// that can be read; one of another size ends the input there (kDamaged). One that is missing or cannot be read becomes
// a damaged frame of even grey, so the frames after it keep their numbers; one warning names them all.
// From the second picture on they are read ahead, as InputOptions::threads says.
// Fails with kUnreadable (no such place, no plain file, no picture in it), else with the first picture's problem where
// none can be read.
[[nodiscard]] tl::expected<std::unique_ptr<FrameSource>, InputError> open_pictures(const std::string& path,
                                                                                   const InputOptions& options);

// Returns the files an INPUT of any kind consists of, in order: the pictures of a folder or pattern that exist, else
// the one file. Fails with kUnreadable.
[[nodiscard]] tl::expected<std::vector<std::string>, InputError> files_of_input(const std::string& path,
                                                                                const InputOptions& options);

}  // namespace moiregauge::internal
