// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/circles/adaptive_threshold.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "moiregauge/phase/fit/simd_target.h"

namespace moiregauge::internal::markers_detail {
namespace {

constexpr int kMinContrast = 14;
constexpr std::uint64_t kDarkPartsSeed = 20240611;

GreyView view_of(const cv::Mat& picture) {
  return {picture.data, picture.cols, picture.rows, static_cast<std::ptrdiff_t>(picture.step)};
}

// Paints flat paper with 0 to 5 uniform patches and noise of 0 to 7 grey levels.
cv::Mat paper_with_patches(int width, int height, std::mt19937_64& rng) {
  const auto below = [&rng](int n) { return static_cast<int>(rng() % static_cast<unsigned>(n)); };
  cv::Mat picture(height, width, CV_8U, cv::Scalar(100 + below(100)));
  for (int i = below(6); i > 0; --i) {
    const int x = below(width), y = below(height);
    const cv::Rect patch = cv::Rect(x, y, 1 + below(40), 1 + below(40)) & cv::Rect(0, 0, width, height);
    picture(patch).setTo(cv::Scalar(below(256)));
  }
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x)
      picture.at<uchar>(y, x) = static_cast<uchar>(std::min(255, picture.at<uchar>(y, x) + below(8)));
  }
  return picture;
}

int mirrored(int i, int count) { return i < 0 ? -i : i < count ? i : 2 * count - 2 - i; }

int smoothed(const cv::Mat& picture, int x, int y) {
  int sum = 8;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const int weight = (dx == 0 ? 2 : 1) * (dy == 0 ? 2 : 1);
      sum += weight * picture.at<uchar>(mirrored(y + dy, picture.rows), mirrored(x + dx, picture.cols));
    }
  }
  return sum / 16;
}

// Returns the threshold of a tile by its definition, pixel by pixel.
int threshold_at(const cv::Mat& smooth, int tile_x, int tile_y) {
  int low = 255, high = 0;
  for (int y = std::max(0, 4 * tile_y - 4); y < std::min(smooth.rows, 4 * tile_y + 8); ++y) {
    for (int x = std::max(0, 4 * tile_x - 4); x < std::min(smooth.cols, 4 * tile_x + 8); ++x) {
      low = std::min<int>(low, smooth.at<uchar>(y, x));
      high = std::max<int>(high, smooth.at<uchar>(y, x));
    }
  }
  return high - low < kMinContrast ? 0 : (low + high + 1) / 2;
}

cv::Mat dark_by_definition(const cv::Mat& picture) {
  cv::Mat smooth(picture.size(), CV_8U), dark(picture.size(), CV_8U);
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) smooth.at<uchar>(y, x) = static_cast<uchar>(smoothed(picture, x, y));
  }
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x)
      dark.at<uchar>(y, x) = smooth.at<uchar>(y, x) < threshold_at(smooth, x / 4, y / 4) ? 1 : 0;
  }
  return dark;
}

cv::Mat dark_by_parts(const cv::Mat& picture, const TileThresholds& thresholds) {
  cv::Mat dark(picture.size(), CV_8U, cv::Scalar(0));
  std::vector<std::uint8_t> memory;
  for (const PicturePart& part : thresholds.parts) {
    const GreyView found = dark_part(view_of(picture), thresholds, part, memory);
    for (int y = 0; y < part.height; ++y) std::ranges::copy(found.row(y), dark.ptr(part.y + y) + part.x);
  }
  return dark;
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  if (a.size() != b.size()) return false;
  for (int y = 0; y < a.rows; ++y) {
    if (!std::equal(a.ptr(y), a.ptr(y) + a.cols, b.ptr(y))) return false;
  }
  return true;
}

// The widths include the sizes of tiles, blocks and strips and their neighbours.
TEST(DarkParts, EqualTheThresholdedWholeImageOnEverySimdTarget) {
  std::mt19937_64 rng(kDarkPartsSeed);
  for (const int width : {8, 9, 31, 255, 256, 257, 287, 288, 289, 300, 545}) {
    const int height = 8 + static_cast<int>(rng() % 120);
    const cv::Mat picture = paper_with_patches(width, height, rng);
    const cv::Mat truth = dark_by_definition(picture);
    for (const std::string& target : simd_targets()) {
      ASSERT_TRUE(use_simd_target(target));
      const TileThresholds thresholds = tile_thresholds(view_of(picture), kMinContrast, nullptr);
      EXPECT_TRUE(same(dark_by_parts(picture, thresholds), truth)) << target << ' ' << width << " x " << height;
    }
  }
  ASSERT_TRUE(use_simd_target(simd_targets().front()));
}

TEST(DarkParts, AreSeparateAndExcludeThePaper) {
  cv::Mat picture(200, 600, CV_8U, cv::Scalar(180));
  picture(cv::Rect(40, 60, 30, 30)).setTo(cv::Scalar(40));
  picture(cv::Rect(400, 60, 30, 30)).setTo(cv::Scalar(40));
  const auto parts = tile_thresholds(view_of(picture), kMinContrast, nullptr).parts;
  ASSERT_EQ(parts.size(), 2U);
  for (const PicturePart& part : parts) EXPECT_LT(part.width * part.height, 5000);
  EXPECT_GT(std::abs(parts[0].x - parts[1].x), parts[0].width + kTilePx);
}

TEST(Halved, IsTheMeanOfTwoByTwoOnEverySimdTarget) {
  std::mt19937_64 rng(kDarkPartsSeed);
  for (const int width : {8, 63, 64, 65, 131, 200}) {
    const cv::Mat picture = paper_with_patches(width, 33, rng);
    for (const std::string& target : simd_targets()) {
      ASSERT_TRUE(use_simd_target(target));
      const Image<std::uint8_t> half = halved(view_of(picture));
      Image<std::uint8_t> by_the_way;
      (void)tile_thresholds(view_of(picture), kMinContrast, &by_the_way);
      ASSERT_EQ(half.width(), width / 2);
      ASSERT_EQ(half.height(), 16);
      for (int y = 0; y < half.height(); ++y) {
        for (int x = 0; x < half.width(); ++x) {
          int sum = 2;
          for (int i = 0; i < 4; ++i) sum += picture.at<uchar>(2 * y + i / 2, 2 * x + i % 2);
          ASSERT_EQ(half.at(x, y), sum / 4) << target;
          ASSERT_EQ(by_the_way.at(x, y), sum / 4) << target;
        }
      }
    }
  }
  ASSERT_TRUE(use_simd_target(simd_targets().front()));
}

TEST(TileSums, EqualTheSmallestAndLargestWholeTileOnEverySimdTarget) {
  std::mt19937_64 rng(kDarkPartsSeed);
  for (const int width : {4, 11, 127, 128, 130, 260}) {
    const cv::Mat picture = paper_with_patches(width, 8, rng);
    TileSums truth;
    for (int x = 0; x + 4 <= width; x += 4) {
      int sum = 0;
      for (int i = 0; i < 16; ++i) sum += picture.at<uchar>(4 + i / 4, x + i % 4);
      truth = {std::min(truth.smallest, sum), std::max(truth.largest, sum)};
    }
    for (const std::string& target : simd_targets()) {
      ASSERT_TRUE(use_simd_target(target));
      TileSums sums;
      tile_row_sums(view_of(picture), 1, sums);
      EXPECT_EQ(sums.smallest, truth.smallest) << target << ' ' << width;
      EXPECT_EQ(sums.largest, truth.largest) << target << ' ' << width;
    }
  }
  ASSERT_TRUE(use_simd_target(simd_targets().front()));
}

}  // namespace
}  // namespace moiregauge::internal::markers_detail
