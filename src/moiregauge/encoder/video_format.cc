// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <iterator>

#include <fmt/format.h>

#include "moiregauge/encoder/video_writer.h"

namespace moiregauge::internal {
namespace {

struct Row {
  VideoCodec codec;
  const char* word;
  const char* file_name;
  int lowest, highest;  // range of the quality; 0, 0: not adjustable
};

constexpr std::array kRows{Row{VideoCodec::kFfv1, "ffv1", "video.mkv", 0, 0},
                           Row{VideoCodec::kX264, "x264", "video.mp4", 0, 51},
                           Row{VideoCodec::kMjpeg, "mjpeg", "video.mkv", 2, 31}};

const Row& row_of(VideoCodec codec) {
  for (const Row& row : kRows) {
    if (row.codec == codec) return row;
  }
  return kRows.front();
}

}  // namespace

const char* word_for(VideoCodec codec) { return row_of(codec).word; }
const char* file_name_for(VideoCodec codec) { return row_of(codec).file_name; }

std::optional<VideoCodec> codec_named(const std::string& word) {
  for (const Row& row : kRows) {
    if (row.word == word) return row.codec;
  }
  return std::nullopt;
}

std::optional<std::string> problem_with(const VideoFormat& format) {
  const Row& row = row_of(format.codec);
  const bool is_lossless = format.codec == VideoCodec::kFfv1;
  if (format.bits > 8 && !is_lossless) {
    return fmt::format("{} holds 8 bits: the scenario has {}: give --codec ffv1", row.word, format.bits);
  }
  constexpr int kDepths[] = {8, 9, 10, 12, 16};
  if (std::find(std::begin(kDepths), std::end(kDepths), format.bits) == std::end(kDepths))
    return fmt::format("ffv1 holds 8, 9, 10, 12 or 16 bits, not {}", format.bits);
  if (!is_lossless && (format.width % 2 != 0 || format.height % 2 != 0)) {
    return fmt::format("{} requires an even width and height: the scenario has {}x{} px: give --codec ffv1", row.word,
                       format.width, format.height);
  }
  if (format.quality && is_lossless) return std::string("ffv1 is lossless: --quality: remove this option");
  if (format.quality && (*format.quality < row.lowest || *format.quality > row.highest)) {
    return fmt::format("the quality is out of range: --quality {}: give {} to {} for {}", *format.quality, row.lowest,
                       row.highest, row.word);
  }
  if (format.gop < 1) return std::string("the key frame interval is out of range: --gop: give 1 or more");
  return std::nullopt;
}

}  // namespace moiregauge::internal
