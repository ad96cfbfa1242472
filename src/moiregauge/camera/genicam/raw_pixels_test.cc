// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/camera/genicam/raw_pixels.h"

#include <cmath>

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

constexpr std::uint32_t kMono8 = 0x01080001, kMono12 = 0x01100005, kMono12Packed = 0x010c0006,
                        kMono10Packed = 0x010c0004, kMono12p = 0x010c0047, kMono10p = 0x010a0046,
                        kBayerRG8 = 0x01080009, kBayerGB8 = 0x0108000a, kRgb8 = 0x02180014, kYuv422 = 0x0210001f;

std::vector<int> greys(std::uint32_t pfnc, std::vector<std::uint8_t> bytes, int width, int height,
                       MosaicGrey mosaic = MosaicGrey::kGreen) {
  RawToLuma converter(*raw_layout(pfnc), mosaic);
  const auto luma = converter.luma({bytes, width, height, 0});
  std::vector<int> all;
  if (!luma) return all;
  std::visit(
      [&](const auto& view) {
        for (int y = 0; y < view.height; ++y)
          for (int x = 0; x < view.width; ++x) all.push_back(view.at(x, y));
      },
      *luma);
  return all;
}

// The bytes are those of the figures in PFNC 2.1 and GigE Vision 1.2, for the pixels 0xABC and 0x123.
TEST(RawPixels, APixelHasTheSameGreyLevelInEveryPackingOfTwelveBits) {
  const std::vector<int> expected = {0xABC, 0x123};
  EXPECT_EQ(greys(kMono12, {0xBC, 0x0A, 0x23, 0x01}, 2, 1), expected);
  EXPECT_EQ(greys(kMono12p, {0xBC, 0x3A, 0x12}, 2, 1), expected);
  EXPECT_EQ(greys(kMono12Packed, {0xAB, 0x3C, 0x12}, 2, 1), expected);
}

// Pixels 0x3A5 (11 1010 0101), 0x01F (00 0001 1111), 0x200, 0x155.
TEST(RawPixels, APixelHasTheSameGreyLevelInEveryPackingOfTenBits) {
  const std::vector<int> expected = {0x3A5, 0x01F, 0x200, 0x155};
  EXPECT_EQ(greys(kMono10p, {0xA5, 0x7F, 0x00, 0x60, 0x55}, 4, 1), expected);
  EXPECT_EQ(greys(kMono10Packed, {0xE9, 0x31, 0x07, 0x80, 0x10, 0x55}, 4, 1), expected);
}

TEST(RawPixels, PackedPixelsOfAnOddWidthContinueInTheNextRow) {
  EXPECT_EQ(greys(kMono12p, {0x01, 0x20, 0x00, 0x03, 0x00}, 1, 3), (std::vector<int>{1, 2, 3}));
}

TEST(RawPixels, WholeRowsKeepTheirPadding) {
  const std::vector<std::uint8_t> bytes = {1, 2, 99, 3, 4, 99};
  RawToLuma converter(*raw_layout(kMono8));
  const auto luma = converter.luma({bytes, 2, 2, 1});
  ASSERT_TRUE(luma);
  const auto& view = std::get<ImageView<std::uint8_t>>(*luma);
  EXPECT_EQ(view.data, bytes.data()) << "whole bytes are borrowed";
  EXPECT_EQ(view.at(0, 1), 3);
}

// A cosine of phase 0 at x = 0 of the sensor. The grey of a cell must be the cosine at the cell's centre, for every
// order of the colours. Otherwise the mosaic would move the grating.
TEST(RawPixels, TheGreenOfAMosaicCellLiesAtTheCentreOfTheCell) {
  constexpr int kWidth = 400;
  constexpr double kPeriod = 23.0, kTwoPiHere = 6.283185307179586;
  std::vector<std::uint8_t> bytes(2 * kWidth);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < kWidth; ++x)
      bytes[static_cast<std::size_t>(y * kWidth + x)] =
          static_cast<std::uint8_t>(std::lround(128.0 + 100.0 * std::cos(kTwoPiHere * x / kPeriod)));
  for (const std::uint32_t pfnc : {0x01080008U, 0x01080009U, 0x0108000aU, 0x0108000bU}) {
    const auto cells = greys(pfnc, bytes, kWidth, 2);
    ASSERT_EQ(cells.size(), kWidth / 2U);
    double in_phase = 0.0, quadrature = 0.0;
    constexpr int kWholePeriods = 184;  // 16 periods of 23 px are 184 cells
    for (int cell = 0; cell < kWholePeriods; ++cell) {
      const double at = 2.0 * cell + 0.5;  // px of the sensor
      in_phase += cells[static_cast<std::size_t>(cell)] * std::cos(kTwoPiHere * at / kPeriod);
      quadrature += cells[static_cast<std::size_t>(cell)] * std::sin(kTwoPiHere * at / kPeriod);
    }
    const double shift_px = std::atan2(quadrature, in_phase) / kTwoPiHere * kPeriod;
    // Rounding twice to whole grey levels gives sigma = sqrt(2 / 12) DN. The phase of 184 samples follows within
    // sigma / a sqrt(2 / n) = 4.3e-4 rad, or 1.6e-3 px. Allow 4 of them. A half-pixel error is 0.5 px.
    EXPECT_NEAR(shift_px, 0.0, 6.4e-3) << std::hex << pfnc;
  }
}

TEST(RawPixels, ColoursOfAMosaicMixLikeThoseOfAPicture) {
  // A cell of red 200, green 100, blue 50: (77 * 200 + 150 * 100 + 29 * 50 + 128) / 256 = 124.9.
  EXPECT_EQ(greys(kBayerRG8, {200, 100, 100, 50}, 2, 2, MosaicGrey::kLuma), std::vector<int>{124});
  EXPECT_EQ(greys(kBayerGB8, {100, 50, 200, 100}, 2, 2, MosaicGrey::kLuma), std::vector<int>{124});
  EXPECT_EQ(greys(kRgb8, {200, 100, 50}, 1, 1), std::vector<int>{124});
  EXPECT_EQ(greys(kBayerRG8, {200, 100, 103, 50}, 2, 2), std::vector<int>{102});
}

TEST(RawPixels, ATruncatedFrameHasNoPixels) {
  for (const std::uint32_t pfnc : {kMono8, kMono12, kMono12p, kMono12Packed, kRgb8, kBayerRG8}) {
    RawToLuma converter(*raw_layout(pfnc));
    const std::vector<std::uint8_t> bytes(100 * 100 - 1);
    EXPECT_FALSE(converter.luma({bytes, 100, 100, 0})) << std::hex << pfnc;
  }
  RawToLuma packed(*raw_layout(kMono12p));
  const std::vector<std::uint8_t> bytes(30'000);
  EXPECT_FALSE(packed.luma({bytes, 100, 100, 4})) << "padding inside a stream of bits";
}

TEST(RawPixels, AFormatWithoutALumaPlaneIsUnknown) { EXPECT_FALSE(raw_layout(kYuv422)); }

}  // namespace
}  // namespace moiregauge::internal
