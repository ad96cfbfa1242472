// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/decoder/stream/luma_plane.h"

#include <cstdint>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "moiregauge/image/luma_of_colour.h"

namespace moiregauge::internal {
namespace {

// A frame of 2 x 1 px whose first plane has these bytes.
struct TinyFrame {
  AVFrame* frame = av_frame_alloc();
  TinyFrame(AVPixelFormat format, const std::vector<std::uint8_t>& bytes) {
    frame->format = format;
    frame->width = 2;
    frame->height = 1;
    av_frame_get_buffer(frame, 0);
    std::memcpy(frame->data[0], bytes.data(), bytes.size());
  }
  TinyFrame(const TinyFrame&) = delete;
  TinyFrame& operator=(const TinyFrame&) = delete;
  ~TinyFrame() { av_frame_free(&frame); }
};

template <typename Grey>
std::vector<Grey> luma_of(AVPixelFormat format, const std::vector<std::uint8_t>& bytes) {
  const TinyFrame tiny(format, bytes);
  std::vector<Grey> out(2);
  copy_luma(*tiny.frame, luma_layout(format).value(), reinterpret_cast<std::byte*>(out.data()));
  return out;
}

using Words = std::vector<std::uint16_t>;
using Bytes = std::vector<std::uint8_t>;

TEST(LumaPlane, LumaInTheHighBitsIsShiftedDown) {
  EXPECT_EQ(luma_layout(AV_PIX_FMT_P010LE)->bits, 10);
  EXPECT_EQ(luma_of<std::uint16_t>(AV_PIX_FMT_P010LE, {0x40, 0x00, 0xc0, 0xff}), (Words{1, 1023}));
}

TEST(LumaPlane, WordsOfEitherByteOrderGiveTheSameLevels) {
  EXPECT_EQ(luma_of<std::uint16_t>(AV_PIX_FMT_GRAY12LE, {0x34, 0x02, 0xff, 0x0f}), (Words{0x234, 4095}));
  EXPECT_EQ(luma_of<std::uint16_t>(AV_PIX_FMT_GRAY12BE, {0x02, 0x34, 0x0f, 0xff}), (Words{0x234, 4095}));
}

TEST(LumaPlane, InterleavedLumaIsExtracted) {
  EXPECT_EQ(luma_of<std::uint8_t>(AV_PIX_FMT_YUYV422, {16, 99, 235, 98}), (Bytes{16, 235}));
  EXPECT_EQ(luma_of<std::uint8_t>(AV_PIX_FMT_UYVY422, {99, 16, 98, 235}), (Bytes{16, 235}));
}

TEST(LumaPlane, RedAndBlueAreNotMixedUp) {
  const auto luma = luma_of_colour<std::uint8_t>(200, 100, 50);
  EXPECT_EQ(luma_of<std::uint8_t>(AV_PIX_FMT_RGB24, {200, 100, 50, 0, 0, 0})[0], luma);
  EXPECT_EQ(luma_of<std::uint8_t>(AV_PIX_FMT_BGR0, {50, 100, 200, 9, 0, 0, 0, 0})[0], luma);
}

TEST(LumaPlane, FormatsWithoutLumaAreRefused) {
  for (const AVPixelFormat format : {AV_PIX_FMT_PAL8, AV_PIX_FMT_BAYER_RGGB8, AV_PIX_FMT_RGB565LE, AV_PIX_FMT_XYZ12LE,
                                     AV_PIX_FMT_GRAYF32LE, AV_PIX_FMT_MONOWHITE, AV_PIX_FMT_VAAPI, AV_PIX_FMT_NONE}) {
    EXPECT_FALSE(luma_layout(format)) << format;
  }
}

}  // namespace
}  // namespace moiregauge::internal
