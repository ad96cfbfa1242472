// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/open_input.h"

#include <filesystem>
#include <system_error>

#include "moiregauge/decoder/video_source.h"
#include "moiregauge/io/pictures/picture_file.h"
#include "moiregauge/io/pictures/picture_source.h"

namespace moiregauge::internal {

tl::expected<std::unique_ptr<FrameSource>, InputError> open_input(const std::string& path,
                                                                  const InputOptions& options) {
  std::error_code ignored;
  const bool is_file = std::filesystem::is_regular_file(path, ignored);
  const bool is_video = !options.sequence && is_file && picture_kind(path) == PictureKind::kNone;
  return is_video ? open_video(path, options) : open_pictures(path, options);
}

}  // namespace moiregauge::internal
