// SPDX-License-Identifier: Apache-2.0
// Frames reached by a skip are those of decoding from the start: number, time, mark, pixels and quantiser.
#include <cmath>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "moiregauge/base/folder_for_tests.h"
#include "moiregauge/decoder/videos_for_tests.h"

namespace moiregauge::internal {
namespace {

constexpr int kSeekFrames = 60, kSeekGroup = 12;  // frames of the video and between key frames

struct DecodedFrame {
  long number = 0;
  double time_s = 0.0;
  bool damaged = false;
  double step = 0.0;  // grey levels, NaN: unknown
  std::vector<std::uint8_t> pixels, blocks;
};

template <typename Grey>
std::vector<std::uint8_t> bytes_of(const ImageView<Grey>& view) {
  std::vector<std::uint8_t> bytes;
  for (int y = 0; y < view.height; ++y) {
    const auto row = view.row(y);
    const auto* data = reinterpret_cast<const std::uint8_t*>(row.data());
    bytes.insert(bytes.end(), data, data + row.size() * sizeof(Grey));
  }
  return bytes;
}

std::vector<DecodedFrame> frames_from(const std::string& path, long first_frame) {
  const auto source = test::opened(path, {.first_frame = first_frame});
  std::vector<DecodedFrame> frames;
  while (source) {
    const auto next = source->next();
    EXPECT_TRUE(next) << next.error().message;
    if (!next || !*next) break;
    const Frame& frame = **next;
    frames.push_back({frame.number, frame.time_s, frame.damaged, frame.quantiser.whole.step,
                      std::visit([](const auto& view) { return bytes_of(view); }, frame.luma),
                      bytes_of(frame.quantiser.blocks)});
  }
  return frames;
}

bool is_same_number(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

void expect_same(const DecodedFrame& skipped, const DecodedFrame& whole) {
  EXPECT_EQ(skipped.number, whole.number);
  EXPECT_TRUE(is_same_number(skipped.time_s, whole.time_s)) << skipped.time_s << " " << whole.time_s;
  EXPECT_EQ(skipped.damaged, whole.damaged);
  EXPECT_TRUE(is_same_number(skipped.step, whole.step)) << skipped.step << " " << whole.step;
  EXPECT_EQ(skipped.blocks, whole.blocks);
  EXPECT_TRUE(skipped.pixels == whole.pixels) << "frame " << whole.number;
}

// Frames from a skip must equal those of the whole. `can_skip`: the format's times determine the numbers, so the skip to
// the last group omits at least half of the frames.
// `is_gradual`: frames that are not yet complete are marked damaged instead.
void expect_equal_after_skips(const std::string& path, bool can_skip, bool is_gradual) {
  const auto whole = frames_from(path, 0);
  ASSERT_EQ(whole.size(), static_cast<std::size_t>(kSeekFrames));
  for (const long wanted : {17L, 38L, 59L}) {
    const auto frames = frames_from(path, wanted);
    ASSERT_FALSE(frames.empty());
    ASSERT_LE(frames.front().number, wanted);
    if (can_skip && wanted == kSeekFrames - 1) {
      EXPECT_GE(frames.front().number, kSeekFrames / 2);
    }
    ASSERT_EQ(frames.back().number, kSeekFrames - 1);
    for (const DecodedFrame& frame : frames) {
      if (is_gradual && frame.damaged) continue;
      if (frame.number >= wanted - 3) expect_same(frame, whole[static_cast<std::size_t>(frame.number)]);
    }
  }
}

struct SeekCase {
  const char* name;
  const char* file;
  const char* how;  // options of ffmpeg for the codec
  bool can_skip = true;
  const char* filter = "null";
  bool is_gradual = false;
};

void PrintTo(const SeekCase& seek, std::ostream* out) { *out << seek.name; }

class VideoSeek : public testing::TestWithParam<SeekCase> {};

TEST_P(VideoSeek, FramesAfterASkipAreThoseOfTheWhole) {
  const TestFolder folder;
  const SeekCase& seek = GetParam();
  const std::string path = folder / seek.file;
  test::ffmpeg(fmt::format("-f lavfi -i testsrc2=size=96x64:rate=25 -vf {} -pix_fmt yuv420p -frames:v {} -g {} {} {}",
                           seek.filter, kSeekFrames, kSeekGroup, seek.how, path));
  expect_equal_after_skips(path, seek.can_skip, seek.is_gradual);
}

constexpr const char* kSteps = "\"setpts='(N*N/40+N)/25/TB'\" -fps_mode passthrough -enc_time_base 1/1000";

INSTANTIATE_TEST_SUITE_P(
    Formats, VideoSeek,
    testing::Values(
        SeekCase{"ClosedGroupsWithReorderedFrames", "a.mp4", "-c:v libx264 -bf 3 -x264-params b-pyramid=normal"},
        SeekCase{"OpenGroups", "a.mp4", "-c:v libx264 -x264-params open-gop=1:bframes=3:min-keyint=12:b-adapt=0"},
        SeekCase{"OpenGroupsInMatroska", "a.mkv", "-c:v libx264 -x264-params open-gop=1:bframes=3:min-keyint=12"},
        SeekCase{"OpenGroupsOfHevc", "a.mp4",
                 "-c:v libx265 -x265-params log-level=none:open-gop=1:bframes=3:min-keyint=12"},
        // Without an edit list, whose end ffmpeg 7 places before the last frame.
        SeekCase{"VariableFrameRate", "a.mp4", "-c:v libx264 -bf 2 -use_editlist 0", true, kSteps},
        SeekCase{"VariableFrameRateInMatroska", "a.mkv", "-c:v libx264 -bf 2", true, kSteps},
        SeekCase{"GradualRefresh", "a.mp4", "-c:v libx264 -x264-params intra-refresh=1:bframes=0", false, "null", true},
        SeekCase{"OneKeyFrame", "a.mp4", "-c:v libx264 -bf 2 -x264-params keyint=infinite:scenecut=0", false},
        SeekCase{"TransportStream", "a.ts", "-c:v libx264 -bf 2"}, SeekCase{"MotionJpeg", "a.avi", "-c:v mjpeg"},
        SeekCase{"ReorderedFramesWithoutTimes", "a.avi", "-c:v mpeg4 -bf 2", false},
        SeekCase{"HiddenReferences", "a.webm", "-c:v libvpx-vp9 -b:v 100k -auto-alt-ref 1 -lag-in-frames 16"},
        SeekCase{"Lossless", "a.mkv", "-c:v ffv1 -level 3"}, SeekCase{"Uncompressed", "a.avi", "-c:v rawvideo", false}),
    [](const auto& chosen) { return std::string(chosen.param.name); });

}  // namespace
}  // namespace moiregauge::internal
