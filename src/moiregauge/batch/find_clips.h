// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/batch/clip.h"

namespace moiregauge::internal {

// Finds the clips of INPUTS: files, folders, and lists `@FILE` with one path per line, relative to the list. The clips
// have no name yet. They are sorted by path, and each occurs once.
// A folder contributes every video by its extension, every folder of two or more images, and every single TIFF below it.
// It skips hidden folders, links to folders, run directories, and the folders of batches, in particular `output`.
// A file that does not exist is a clip too: it fails on its own, and the others are measured.
// Fails with "what happened: where: what to do": a list that cannot be read, or no clip.
[[nodiscard]] tl::expected<std::vector<Clip>, std::string> find_clips(const std::vector<std::string>& inputs,
                                                                      const std::filesystem::path& output);

}  // namespace moiregauge::internal
