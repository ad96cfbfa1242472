// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/decoder/headers/stream_quantiser.h"

#include <cmath>
#include <cstdlib>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "moiregauge/base/folder_for_tests.h"
#include "moiregauge/decoder/video_source.h"

namespace moiregauge::internal {
namespace {

// Stripes that move between frames, so that blocks are coded in each. 16-bit words above 8 bits.
std::string moving_stripes(const TestFolder& folder, const std::string& name, int bits, const std::string& how) {
  constexpr int kWidth = 96, kHeight = 64, kFrames = 6;
  std::ofstream out(folder / "raw", std::ios::binary);
  for (int frame = 0; frame < kFrames; ++frame) {
    for (int k = 0; k < kWidth * kHeight; ++k) {
      const int grey = (((k % kWidth + 3 * frame) / 8 % 2) * 120 + 60 + (k * 7919 + frame * 31) % 23) << (bits - 8);
      out.put(static_cast<char>(grey & 0xff));
      if (bits > 8) out.put(static_cast<char>(grey >> 8));
    }
  }
  out.close();
  const std::string words = fmt::format(
      "ffmpeg -nostdin -v error -y -f rawvideo -pix_fmt {} -s {}x{} -r 25 -i {} {} {}",
      bits == 8 ? "gray" : fmt::format("gray{}le", bits), kWidth, kHeight, folder / "raw", how, folder / name);
  EXPECT_EQ(std::system(words.c_str()), 0) << words;
  return folder / name;
}

// Returns the quantiser of every frame.
std::vector<Quantiser> quantisers(const std::string& path) {
  const auto source = open_video(path, {}, {});
  if (!source) {
    ADD_FAILURE() << source.error().message;
    return {};
  }
  std::vector<Quantiser> all;
  while (true) {
    const auto frame = (*source)->next();
    if (!frame || !*frame) return all;
    all.push_back((*frame)->quantiser.within(0.0, 0.0, 95.0, 63.0));
  }
}

TEST(StreamQuantiser, H264ReportsItsStep) {
  const TestFolder folder;
  for (const int parameter : {18, 30, 42}) {
    const auto path = moving_stripes(
        folder, "a.mkv", 8,
        fmt::format("-c:v libx264 -qp {} -bf 0 -x264-params ipratio=1:aq-mode=0 -pix_fmt yuv420p", parameter));
    const auto all = quantisers(path);
    ASSERT_EQ(all.size(), 6u);
    for (const Quantiser& q : all) {
      EXPECT_TRUE(q.predicted);
      EXPECT_DOUBLE_EQ(q.step, step_of_parameter(parameter));
    }
  }
}

TEST(StreamQuantiser, MoreBitsScaleTheStep) {
  const TestFolder folder;
  const auto path = moving_stripes(folder, "a.mkv", 10,
                                   "-c:v libx264 -qp 30 -bf 0 -x264-params ipratio=1:aq-mode=0 -pix_fmt yuv420p10le");
  for (const Quantiser& q : quantisers(path)) EXPECT_DOUBLE_EQ(q.step, 4.0 * step_of_parameter(30 - 12));
}

// B images and several slices: headers contain all their fields, and frames leave the decoder in another order.
TEST(StreamQuantiser, HevcHasTheStepOfItsSlices) {
  const TestFolder folder;
  const char* kinds[] = {"yuv420p", "yuv422p10le", "yuv444p"};
  const char* more[] = {"bframes=0", "bframes=3:ref=4:slices=2:weightb=1",
                        "no-sao=1:no-temporal-mvp=1:scaling-list=default"};
  for (const int parameter : {18, 30, 42}) {
    for (const char* container : {"a.mkv", "a.mp4", "a.ts"}) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto path = moving_stripes(
            folder, container, 8,
            fmt::format("-c:v libx265 -pix_fmt {} -x265-params log-level=none:qp={}:ipratio=1:pbratio=1:aq-mode=0:{}",
                        kinds[k], parameter, more[k]));
        const auto all = quantisers(path);
        ASSERT_EQ(all.size(), 6u);
        for (const Quantiser& q : all) {
          EXPECT_TRUE(q.predicted);
          EXPECT_DOUBLE_EQ(q.step, step_of_parameter(parameter) * (k == 1 ? 4.0 : 1.0)) << container << " " << more[k];
        }
      }
    }
  }
}

TEST(StreamQuantiser, EveryHevcFrameHasItsOwnStep) {
  const TestFolder folder;
  const auto path = moving_stripes(folder, "a.mkv", 8,
                                   "-c:v libx265 -pix_fmt yuv420p -x265-params "
                                   "log-level=none:qp=30:aq-mode=0:bframes=0:keyint=3:ipratio=2");
  const auto all = quantisers(path);
  ASSERT_EQ(all.size(), 6u);
  for (const std::size_t key : {0, 3}) EXPECT_DOUBLE_EQ(all[key].step, step_of_parameter(24));  // half of 30's step
  for (const std::size_t other : {1, 2, 4, 5}) EXPECT_DOUBLE_EQ(all[other].step, step_of_parameter(30));
}

TEST(StreamQuantiser, MotionJpegHasTheStepOfItsTable) {
  const TestFolder folder;
  double last = 0.0;
  for (const int quality : {2, 4, 8, 16}) {  // ffmpeg's tables are proportional to it, with entries rounded down
    const auto all =
        quantisers(moving_stripes(folder, "a.avi", 8, fmt::format("-c:v mjpeg -q:v {} -pix_fmt yuvj420p", quality)));
    ASSERT_EQ(all.size(), 6u);
    EXPECT_FALSE(all.front().predicted);
    if (last > 0.0) {
      EXPECT_NEAR(all.front().step / last, 2.0, 0.25) << quality;
    }
    last = all.front().step;
  }
  EXPECT_NEAR(last, 46.0, 4.0);  // 16 / 8 times MPEG-1's entries of 16 to 27, 23 rms
}

TEST(StreamQuantiser, LosslessStreamsLoseNothing) {
  const TestFolder folder;
  for (const char* how : {"-c:v ffv1 -pix_fmt gray", "-c:v huffyuv -pix_fmt yuv422p",
                          "-c:v libx264 -qp 0 -pix_fmt yuv444p", "-c:v rawvideo -pix_fmt gray"}) {
    for (const Quantiser& q : quantisers(moving_stripes(folder, "a.mkv", 8, how))) EXPECT_TRUE(q.is_lossless()) << how;
  }
}

TEST(StreamQuantiser, AnUnstatedStepIsUnknown) {
  const TestFolder folder;
  for (const Quantiser& q : quantisers(moving_stripes(folder, "a.mkv", 8, "-c:v jpeg2000 -pix_fmt gray")))
    EXPECT_TRUE(std::isnan(q.step));
}

TEST(StreamQuantiser, ATruncatedJpegHeaderGivesAnUnknownStep) {
  const std::vector<std::uint8_t> nothing{0xff, 0xd8, 0xff, 0xdb, 0x00, 0x43, 0x00, 0x10};
  for (std::size_t n = 0; n <= nothing.size(); ++n) EXPECT_TRUE(std::isnan(step_of_jpeg(std::span(nothing).first(n))));
}

}  // namespace
}  // namespace moiregauge::internal
