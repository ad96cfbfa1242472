// SPDX-License-Identifier: Apache-2.0
// Grey pictures into a video file, with time stamps of any spacing. Same pictures, same bytes.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "moiregauge/image/image.h"

namespace moiregauge::internal {

enum class VideoCodec {
  kFfv1,   // lossless, 8, 10 or 12 bits; for video.mkv
  kX264,   // H.264 as a telephone's: 4:2:0, 8 bits, B frames, constant rate factor; for video.mp4
  kMjpeg,  // every frame a JPEG, 8 bits; for video.mkv
};
[[nodiscard]] const char* word_for(VideoCodec codec);
[[nodiscard]] std::optional<VideoCodec> codec_named(const std::string& word);

struct VideoFormat {
  VideoCodec codec = VideoCodec::kFfv1;
  std::optional<int> quality;  // x264: rate factor, 0 to 51, 23 unless given; mjpeg: quantiser, 2 to 31, 3 unless given
  int gop = 250;               // x264: frames from one key frame to the next at most; 1: key frames only
  int width = 0, height = 0;   // px; even for x264 and mjpeg
  int bits = 8;
  double fps = 30.0;       // nominal
  bool is_linear = false;  // the stream says that its grey levels are light
  bool faststart = false;  // mp4: its index before its pictures, so that it plays while it loads
};

// "video.mkv" or "video.mp4".
[[nodiscard]] const char* file_name_for(VideoCodec codec);
// What cannot be made, in words: "sensor.bits is 12: x264 holds 8".
[[nodiscard]] std::optional<std::string> problem_with(const VideoFormat& format);

// Errors read "path: why".
class VideoWriter {
 public:
  // mp4 or Matroska, by the end of the path. Matroska keeps time stamps to a millisecond, mp4 to 1/90000 s.
  [[nodiscard]] static tl::expected<std::unique_ptr<VideoWriter>, std::string> create(const std::string& path,
                                                                                      const VideoFormat& format);
  virtual ~VideoWriter() = default;
  // The picture is of the format's size and bits (more than 8 in 16-bit words); times rise.
  [[nodiscard]] virtual tl::expected<void, std::string> add(const LumaView& picture, double time_s) = 0;
  // Without it the file is not whole.
  [[nodiscard]] virtual tl::expected<void, std::string> finish() = 0;
};

}  // namespace moiregauge::internal
