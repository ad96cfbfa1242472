// SPDX-License-Identifier: Apache-2.0
// Reads image folders, numbered images, single images and TIFF stacks as a FrameSource.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "moiregauge/run/frame_source.h"

namespace moiregauge::internal {

// Opens the images of a folder, a pattern, a TIFF stack or one file. All must have the size and depth of the first
// readable one. An image of another size ends the input there (kDamaged).
// A missing or unreadable image becomes a damaged frame of uniform grey, so later frames keep their numbers. One
// warning lists them all.
// From the second image on they are read ahead, as `threads` in InputOptions states.
// Fails with kUnreadable (path missing, no plain file, no image in it). If no image can be read, fails with the first
// image's problem.
[[nodiscard]] tl::expected<std::unique_ptr<FrameSource>, InputError> open_pictures(const std::string& path,
                                                                                   const InputOptions& options);

// Returns the files of an INPUT of any kind, in order: the existing images of a folder or pattern, otherwise the file
// itself. Fails with kUnreadable.
[[nodiscard]] tl::expected<std::vector<std::string>, InputError> files_of_input(const std::string& path,
                                                                                const InputOptions& options);

}  // namespace moiregauge::internal
