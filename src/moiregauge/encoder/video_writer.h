// SPDX-License-Identifier: Apache-2.0
// Writes grey images to a video file, with time stamps at any spacing. The same images give the same bytes.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "moiregauge/image/image.h"

namespace moiregauge::internal {

enum class VideoCodec {
  kFfv1,   // lossless, 8, 9, 10, 12 or 16 bits; video.mkv
  kX264,   // H.264 as telephones record it: 4:2:0, 8 bits, B frames, constant rate factor; video.mp4
  kMjpeg,  // every frame a JPEG, 8 bits; video.mkv
};
[[nodiscard]] const char* word_for(VideoCodec codec);
[[nodiscard]] std::optional<VideoCodec> codec_named(const std::string& word);

struct VideoFormat {
  VideoCodec codec = VideoCodec::kFfv1;
  std::optional<int> quality;  // x264: rate factor 0 to 51, default 23; mjpeg: quantiser 2 to 31, default 3; ffv1: none
  int gop = 250;               // x264: largest distance of key frames, in frames; 1: key frames only
  int width = 0, height = 0;   // px; even for x264 and mjpeg
  int bits = 8;
  double fps = 30.0;       // nominal, frames/s
  bool is_linear = false;  // tags the stream: grey levels are proportional to light
  bool faststart = false;  // mp4: puts the index before the images, so that the file plays while it loads
};

// Returns "video.mkv" or "video.mp4".
[[nodiscard]] const char* file_name_for(VideoCodec codec);
// Returns the reason why this format cannot be written, or nothing if it can.
[[nodiscard]] std::optional<std::string> problem_with(const VideoFormat& format);

// Errors of all functions name the path and the reason.
class VideoWriter {
 public:
  // Creates an mp4 or Matroska file, by the extension of the path. Time stamps are rounded to 1 ms (Matroska) or
  // 1/90000 s (mp4).
  [[nodiscard]] static tl::expected<std::unique_ptr<VideoWriter>, std::string> create(const std::string& path,
                                                                                      const VideoFormat& format);
  virtual ~VideoWriter() = default;
  // Adds a frame. It has the size and bits of the format (above 8 bits in 16-bit words). `time_s` must increase.
  [[nodiscard]] virtual tl::expected<void, std::string> add(const LumaView& picture, double time_s) = 0;
  // Completes the file, which is unusable without this call.
  [[nodiscard]] virtual tl::expected<void, std::string> finish() = 0;
};

}  // namespace moiregauge::internal
