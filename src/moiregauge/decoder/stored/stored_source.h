// SPDX-License-Identifier: Apache-2.0
// Frames of an uncompressed video straight from the file's pages: nothing is copied, and what no window looks at is
// never read.
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
  void let_go(std::size_t frame) const;  // its pixels have been looked at
};

// Null unless every picture lies in the file as it was.
[[nodiscard]] std::optional<MappedVideo> map_video(const std::string& path);

// `info` as the decoder gives it for the same file.
// fails      next(): kDamaged (the file is cut short while it is measured)
[[nodiscard]] std::unique_ptr<FrameSource> stored_source(MappedVideo video, InputInfo info,
                                                         const InputOptions& options);

}  // namespace moiregauge::internal
