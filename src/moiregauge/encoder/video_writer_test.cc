// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/encoder/video_writer.h"

#include <cmath>
#include <fstream>
#include <iterator>
#include <vector>

#include <gtest/gtest.h>

#include "moiregauge/base/folder_for_tests.h"
#include "moiregauge/decoder/video_source.h"

namespace moiregauge::internal {
namespace {

// Not smaller: for 64 x 48 px the widest vector instructions of x264 read beyond the image, and its bytes vary between
// runs.
constexpr int kWidth = 256, kHeight = 192, kFrames = 6;
constexpr double kTimes[kFrames] = {0.2, 0.25, 0.31, 0.32, 0.5, 0.6};  // s, uneven spacing

// A moving wave with deterministic noise.
int grey_at(int frame, int x, int y, int bits) {
  const double wave = 110.0 + 60.0 * std::sin(0.4 * (x + 0.7 * frame)) + 20.0 * std::sin(0.3 * y);
  const int noise = (x * 7919 + y * 104729 + frame * 1299709) % 5 - 2;
  return static_cast<int>(std::lround((wave + noise) * (1 << (bits - 8))));
}

template <typename Grey>
Image<Grey> picture(int frame, int bits) {
  Image<Grey> image(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) image.at(x, y) = static_cast<Grey>(grey_at(frame, x, y, bits));
  }
  return image;
}

VideoFormat format_of(VideoCodec codec, std::optional<int> quality = {}, int bits = 8) {
  VideoFormat format;
  format.codec = codec;
  format.quality = quality;
  format.width = kWidth;
  format.height = kHeight;
  format.bits = bits;
  format.fps = 15.0;
  return format;
}

void write(const std::string& path, const VideoFormat& format) {
  auto writer = VideoWriter::create(path, format);
  ASSERT_TRUE(writer) << writer.error();
  for (int frame = 0; frame < kFrames; ++frame) {
    const auto deep = picture<std::uint16_t>(frame, format.bits);
    const auto shallow = picture<std::uint8_t>(frame, 8);
    const LumaView view = format.bits > 8 ? LumaView(deep.view()) : LumaView(shallow.view());
    const auto added = (*writer)->add(view, kTimes[frame]);
    ASSERT_TRUE(added) << added.error();
  }
  const auto finished = (*writer)->finish();
  ASSERT_TRUE(finished) << finished.error();
}

struct Read {
  std::vector<double> times;
  double rms = 0.0;  // rms difference from the written frames, grey levels
  InputInfo info;
};

Read read(const std::string& path) {
  Read read;
  auto source = open_video(path, {});
  EXPECT_TRUE(source) << source.error().message;
  if (!source) return read;
  read.info = (*source)->info();
  double sum = 0.0;
  while (true) {
    const auto frame = (*source)->next();
    EXPECT_TRUE(frame) << frame.error().message;
    if (!frame || !*frame) break;
    EXPECT_FALSE((*frame)->damaged);
    const int number = static_cast<int>(read.times.size());
    read.times.push_back((*frame)->time_s);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const int grey = std::visit([&](const auto& view) { return int(view.at(x, y)); }, (*frame)->luma);
        sum += std::pow(grey - grey_at(number, x, y, read.info.bits), 2);
      }
    }
  }
  read.rms = std::sqrt(sum / (kWidth * kHeight * std::max<double>(1.0, double(read.times.size()))));
  return read;
}

std::string bytes_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void expect_times(const Read& read, double within) {
  ASSERT_EQ(read.times.size(), std::size_t{kFrames});
  for (int frame = 0; frame < kFrames; ++frame)
    EXPECT_NEAR(read.times[std::size_t(frame)], kTimes[frame] - kTimes[0], within);
}

TEST(VideoWriter, Ffv1KeepsEveryGreyLevelAtEveryDepth) {
  const TestFolder folder;
  for (const int bits : {8, 9, 10, 12, 16}) {
    write(folder / "a.mkv", format_of(VideoCodec::kFfv1, {}, bits));
    const Read back = read(folder / "a.mkv");
    EXPECT_EQ(back.info.bits, bits);
    EXPECT_EQ(back.rms, 0.0);
    expect_times(back, 0.0006);  // Matroska rounds to 1 ms
  }
}

TEST(VideoWriter, X264ErrorGrowsWithTheRateFactor) {
  const TestFolder folder;
  double before = 0.0;
  for (const int crf : {5, 18, 28, 40}) {
    write(folder / "a.mp4", format_of(VideoCodec::kX264, crf));
    const Read back = read(folder / "a.mp4");
    EXPECT_EQ(back.info.codec, "h264");
    expect_times(back, 1.0 / 90000);
    EXPECT_GT(back.rms, before) << crf;
    before = back.rms;
  }
  EXPECT_LT(before, 30.0) << "still the same picture, in the same order";
}

TEST(VideoWriter, MjpegErrorGrowsWithTheQuantiser) {
  const TestFolder folder;
  double before = 0.0;
  for (const int q : {2, 8, 25}) {
    write(folder / "a.mkv", format_of(VideoCodec::kMjpeg, q));
    const Read back = read(folder / "a.mkv");
    EXPECT_EQ(back.info.codec, "mjpeg");
    expect_times(back, 0.0006);
    EXPECT_GT(back.rms, before) << q;
    before = back.rms;
  }
  EXPECT_LT(before, 30.0);
}

TEST(VideoWriter, WritesTheSameBytesEveryTime) {
  const TestFolder folder;
  for (const VideoCodec codec : {VideoCodec::kFfv1, VideoCodec::kX264, VideoCodec::kMjpeg}) {
    const std::string a = folder / (std::string("a-") + file_name_for(codec));
    const std::string b = folder / (std::string("b-") + file_name_for(codec));
    write(a, format_of(codec));
    write(b, format_of(codec));
    EXPECT_GT(bytes_of(a).size(), 500U);
    EXPECT_EQ(bytes_of(a), bytes_of(b)) << word_for(codec);
  }
}

TEST(VideoWriter, InvalidFormatsAreRefusedWithAReason) {
  const TestFolder folder;
  const auto why = [&](const std::string& path, const VideoFormat& format) {
    const auto writer = VideoWriter::create(path, format);
    return writer ? std::string() : writer.error();
  };
  EXPECT_NE(why(folder / "a.mp4", format_of(VideoCodec::kX264, {}, 12)).find("x264 holds 8"), std::string::npos);
  EXPECT_NE(why(folder / "a.mkv", format_of(VideoCodec::kFfv1, {}, 14)).find("not 14"), std::string::npos);
  EXPECT_NE(why(folder / "a.mp4", format_of(VideoCodec::kX264, 60)).find("0 to 51"), std::string::npos);
  EXPECT_NE(why(folder / "a.mkv", format_of(VideoCodec::kFfv1, 3)).find("lossless"), std::string::npos);
  EXPECT_NE(why(folder / "no/a.mkv", format_of(VideoCodec::kFfv1)).find("No such file"), std::string::npos);
  auto odd = format_of(VideoCodec::kMjpeg);
  odd.width = 63;
  EXPECT_NE(why(folder / "a.mkv", odd).find("even"), std::string::npos);
}

}  // namespace
}  // namespace moiregauge::internal
