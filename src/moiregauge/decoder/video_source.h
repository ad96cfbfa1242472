// SPDX-License-Identifier: Apache-2.0
// Reads video files as a FrameSource. A child process decodes them (reasons: child_process.h).
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include <tl/expected.hpp>

#include "moiregauge/decoder/child/child_process.h"
#include "moiregauge/run/frame_source.h"

namespace moiregauge::internal {

struct DecoderOptions {
  // The program whose `--decode-child` mode decodes. Every program linked with this module has that mode.
  std::string child_program = default_child_program();
  std::chrono::milliseconds watchdog = std::chrono::seconds(10);  // silence after which the child is killed
  bool in_place = true;                                           // false: uncompressed video is decoded too
  // Frames before this one may be omitted, which is faster. Numbers, times, pixels and quantisers of the others are
  // those of decoding from the start. The first frame may therefore have any number up to this one. After damage in the
  // omitted part, numbers can differ where frames are reordered.
  // Frames that a gradual refresh has not completed are marked damaged. The end of the file is not checked.
  // Fails in addition: kDamaged, if decoding must begin at the start.
  long first_frame = 0;
};

// Opens the luma of a file's video stream: native depth, upright, with the stream's own time stamps.
//
// Containers: mp4/mov, mkv/webm, avi, mpeg-ts, y4m. No other file is opened, even if this one names some.
// A frame is marked damaged if decoding it raised any error, or if it depends on such a frame (up to the next key
// frame). Three frames on either side are marked too.
// No image of more than `max_pixels` (InputOptions) is decoded.
// Uncompressed grey and planar YUV in AVI and Matroska is read in place (stored_video.h), after the decoder has given
// the same first frame.
//
// Fails: kUnreadable (missing, empty), kUnsupported (no such video, unknown pixel layout, mirrored).
// The function next() fails with kDamaged: the file ends early, the image size changes, time runs backwards, the
// decoder died or blocked.
[[nodiscard]] tl::expected<std::unique_ptr<FrameSource>, InputError> open_video(const std::string& path,
                                                                                const InputOptions& options,
                                                                                const DecoderOptions& decoder = {});

}  // namespace moiregauge::internal
