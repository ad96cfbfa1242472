// SPDX-License-Identifier: Apache-2.0
// Stores the clips of a batch and the options of their measurement as JSON lines.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/batch/clip.h"

namespace moiregauge::internal {

// Options of each clip's measurement.
struct ClipOptions {
  std::vector<std::string> measure;  // options of `measure` as typed, e.g. "--fps=10"
  bool names_markers = false;        // --site or --pitch is among them, so no site.toml next to a clip is used
  int threads = 1;                   // per clip
  double time_limit_s = 0.0;         // 0: none
  std::int64_t memory_limit_bytes = 0;
};

struct Manifest {
  ClipOptions options;
  std::vector<Clip> clips;
};

// Writes a manifest as a whole. Fails with path and reason.
[[nodiscard]] tl::expected<void, std::string> write_manifest(const std::filesystem::path& path,
                                                             const Manifest& manifest);

// Reads a manifest. Fails with "what happened: where: what to do".
[[nodiscard]] tl::expected<Manifest, std::string> read_manifest(const std::filesystem::path& path);

// Calls `see` for each clip of a manifest in its order, without storing them. Fails as read_manifest.
[[nodiscard]] tl::expected<void, std::string> for_each_clip(const std::filesystem::path& path,
                                                            const std::function<void(const Clip&)>& see);

// Returns the clips with their names, and adds those that are new to the list in OUT. A clip keeps its name.
// Fails as read_manifest and write_manifest.
[[nodiscard]] tl::expected<std::vector<Clip>, std::string> register_clips(const BatchFolder& folder,
                                                                          std::vector<Clip> clips);

}  // namespace moiregauge::internal
