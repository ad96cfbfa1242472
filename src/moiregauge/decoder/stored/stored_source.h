// SPDX-License-Identifier: Apache-2.0
// Reads frames of an uncompressed video in place, without a copy. Pages that no measurement accesses are never read.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "moiregauge/base/mapped_file.h"
#include "moiregauge/decoder/stored/stored_video.h"
#include "moiregauge/run/frame_source.h"

namespace moiregauge::internal {

struct MappedVideo {
  std::shared_ptr<const MappedFile> file;
  StoredVideo video;
  [[nodiscard]] LumaView luma(std::size_t frame) const;
  void let_go(std::size_t frame) const;  // releases the pages of a frame
};

// Maps a video. Returns nothing unless every image is stored uncompressed in the file.
[[nodiscard]] std::optional<MappedVideo> map_video(const std::string& path);

// Creates a source. `info` is the decoder's for the same file.
// next() fails with kDamaged if the file is truncated during the measurement.
[[nodiscard]] std::unique_ptr<FrameSource> stored_source(MappedVideo video, InputInfo info,
                                                         const InputOptions& options);

}  // namespace moiregauge::internal
