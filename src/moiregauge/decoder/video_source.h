// SPDX-License-Identifier: Apache-2.0
// Video files as a FrameSource. A child process decodes; see child_process.h for why and how.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include <tl/expected.hpp>

#include "moiregauge/run/frame_source.h"

namespace moiregauge::internal {

struct DecoderOptions {
  // The program whose `--decode-child` mode decodes. Every program linked with this module has that mode; only one
  // that is loaded into a foreign program (a Python module) must name another.
  std::string child_program = "/proc/self/exe";
  std::chrono::milliseconds watchdog = std::chrono::seconds(10);  // silence after which the child is killed
  bool in_place = true;  // false: uncompressed video goes through the decoder too
};

// Luma of the file's video stream at native depth, upright, with the stream's own time stamps.
//
// Containers: mp4/mov, mkv/webm, avi, mpeg-ts, y4m. Nothing but this one file is opened, whatever it says.
// A frame whose decoding raised any complaint, those that lean on it (to the next key frame), and three frames on
// either side of them are marked damaged. No picture of more than InputOptions::max_pixels is decoded. Uncompressed
// grey and planar YUV in AVI and Matroska, whole and plain, is read where it lies in the file (stored_video.h), once
// the decoder has shown the same first frame. fails      kUnreadable (missing, empty), kUnsupported (no such video,
// unknown layout of pixels, mirrored);
//            next(): kDamaged (the file ends early, the picture changes its size, time runs backwards, the decoder died
//            or hung)
[[nodiscard]] tl::expected<std::unique_ptr<FrameSource>, InputError> open_video(const std::string& path,
                                                                                const InputOptions& options,
                                                                                const DecoderOptions& decoder = {});

}  // namespace moiregauge::internal
