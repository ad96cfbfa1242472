// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/markers/candidate_outlines.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace moiregauge::markers_detail {
namespace {

constexpr int kLevels = 4;        // scales 1, 1/2, 1/4, 1/8: neighbourhoods of 12, 24, 48 and 96 px
constexpr int kTilePx = 4;        // threshold per tile, from the extremes of 3 x 3 tiles (as AprilTag 2, Wang 2016)
constexpr int kMinContrast = 14;  // of 255: below it a neighbourhood is flat; > the range of 5 DN noise, smoothed
constexpr double kMinRangeShare = 0.1;   // of full scale: a picture of less range is not stretched further (noise)
constexpr double kMinLevelDiameter = 5;  // px of a level: fewer do not make an outline
constexpr double kMaxLevelDiameter = 110;
constexpr double kMinCircularity = 0.62;  // of the digitised outline; far below 0.84 since chain code errs by 5 - 10 %
constexpr double kMinAxisRatio = 0.3;     // rounder than any circle W > 0.84 can pass (0.5)

// The picture in 8 bits, stretched so that its range counts whatever its depth. The range is that of 4 x 4 means, so
// that hot pixels have no say and a few small dark discs do.
cv::Mat eight_bit(const cv::Mat& picture) {
  cv::Mat coarse;
  const cv::Size size(std::max(1, picture.cols / 4), std::max(1, picture.rows / 4));
  cv::resize(picture, coarse, size, 0, 0, cv::INTER_AREA);
  double low = 0.0, high = 0.0;
  cv::minMaxLoc(coarse, &low, &high);
  const double full = picture.depth() == CV_8U ? 255.0 : std::max(1023.0, high);
  if (picture.depth() == CV_8U && high - low > 0.5 * full) return picture;
  const double range = std::max(high - low, kMinRangeShare * full);
  cv::Mat out;
  picture.convertTo(out, CV_8U, 240.0 / range, 8.0 - low * 240.0 / range);
  return out;
}

cv::Mat eight_bit(const LumaView& luma) {
  return std::visit(
      [](const auto& view) {
        const int type = sizeof(view.data[0]) == 1 ? CV_8U : CV_16U;
        // cv::Mat has no read-only form; it is only read here.
        void* pixels = const_cast<void*>(static_cast<const void*>(view.data));
        return eight_bit(cv::Mat(view.height, view.width, type, pixels,
                                 static_cast<std::size_t>(view.stride) * sizeof(view.data[0])));
      },
      luma);
}

// Smallest and largest grey level of each tile; the last tile of a row or column may be narrower.
void tile_extremes(const cv::Mat& picture, cv::Mat& low, cv::Mat& high) {
  const int columns = (picture.cols + kTilePx - 1) / kTilePx, rows = (picture.rows + kTilePx - 1) / kTilePx;
  low.create(rows, columns, CV_8U);
  high.create(rows, columns, CV_8U);
  std::vector<uchar> smallest(static_cast<std::size_t>(columns) * kTilePx), largest(smallest.size());
  for (int tile_y = 0; tile_y < rows; ++tile_y) {
    std::fill(smallest.begin(), smallest.end(), uchar{255});
    std::fill(largest.begin(), largest.end(), uchar{0});
    for (int y = tile_y * kTilePx; y < std::min((tile_y + 1) * kTilePx, picture.rows); ++y) {
      const uchar* row = picture.ptr<uchar>(y);
      uchar* s = smallest.data();
      uchar* l = largest.data();
      for (int x = 0; x < picture.cols; ++x) {
        s[x] = std::min(s[x], row[x]);
        l[x] = std::max(l[x], row[x]);
      }
    }
    uchar* low_row = low.ptr<uchar>(tile_y);
    uchar* high_row = high.ptr<uchar>(tile_y);
    for (int t = 0; t < columns; ++t) {
      const uchar* s = smallest.data() + t * kTilePx;
      const uchar* l = largest.data() + t * kTilePx;
      low_row[t] = std::min(std::min(s[0], s[1]), std::min(s[2], s[3]));
      high_row[t] = std::max(std::max(l[0], l[1]), std::max(l[2], l[3]));
    }
  }
  static_assert(kTilePx == 4);
}

// 1 where the picture is darker than half-way between the extremes of its neighbourhood, 0 elsewhere and where it is
// flat. Dark discs have outer outlines here, light ones are holes.
cv::Mat locally_dark(const cv::Mat& smooth) {
  cv::Mat low, high, dark(smooth.size(), CV_8U);
  tile_extremes(smooth, low, high);
  const cv::Mat three = cv::Mat::ones(3, 3, CV_8U);
  cv::erode(low, low, three);
  cv::dilate(high, high, three);
  std::vector<uchar> threshold(static_cast<std::size_t>(low.cols) * kTilePx);
  for (int y = 0; y < smooth.rows; ++y) {
    if (y % kTilePx == 0) {
      const uchar* low_row = low.ptr<uchar>(y / kTilePx);
      const uchar* high_row = high.ptr<uchar>(y / kTilePx);
      for (int t = 0; t < low.cols; ++t) {
        const int middle = (low_row[t] + high_row[t] + 1) / 2;
        const auto level = static_cast<uchar>(high_row[t] - low_row[t] < kMinContrast ? 0 : middle);
        std::fill_n(threshold.begin() + t * kTilePx, kTilePx, level);
      }
    }
    const uchar* row = smooth.ptr<uchar>(y);
    const uchar* level = threshold.data();
    uchar* out = dark.ptr<uchar>(y);
    for (int x = 0; x < smooth.cols; ++x) out[x] = row[x] < level[x] ? 1 : 0;
  }
  return dark;
}

// Length of an 8-connected outline by chain code: 0.948 per straight and 1.340 per diagonal step, unbiased over all
// directions (Proffitt and Rosen 1979).
double chain_length(const std::vector<cv::Point>& outline) {
  int straight = 0, diagonal = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const cv::Point step = outline[(i + 1) % outline.size()] - outline[i];
    (step.x != 0 && step.y != 0 ? diagonal : straight)++;
  }
  return 0.948 * straight + 1.340 * diagonal;
}

struct Moments {
  double area = 0.0;
  Eigen::Vector2d mean;
  Eigen::Matrix2d covariance;
};

// Green's formula over the polygon through the pixel centres.
Moments moments_of(const std::vector<cv::Point>& outline) {
  const cv::Moments m = cv::moments(outline);
  Moments out;
  out.area = m.m00;
  out.mean = {m.m10 / m.m00, m.m01 / m.m00};
  out.covariance << m.mu20, m.mu11, m.mu11, m.mu02;
  out.covariance /= m.m00;
  return out;
}

void add_outlines(const cv::Mat& dark, double scale, DiameterRange level_px, std::vector<CandidateOutline>& out) {
  std::vector<std::vector<cv::Point>> outlines;
  cv::findContours(dark, outlines, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
  for (const auto& outline : outlines) {
    const auto n = static_cast<double>(outline.size());
    // A digitised circle has about 2.83 outline pixels per pixel of diameter, an ellipse or a ragged circle up to
    // twice.
    if (n < 2.0 * level_px.min_px || n > 6.0 * level_px.max_px) continue;
    const cv::Rect box = cv::boundingRect(outline);
    if (std::min(box.width, box.height) < kMinAxisRatio * std::max(box.width, box.height)) continue;
    const Moments moments = moments_of(outline);
    if (moments.area <= 0.0) continue;
    // The polygon runs through pixel centres, so half a pixel inside (outer outline) or outside (hole) the true edge: W
    // is computed of the polygon itself, whose length the chain code gives.
    const double length = chain_length(outline);
    const double circularity = 4.0 * CV_PI * moments.area / (length * length);
    if (circularity < kMinCircularity) continue;
    Ellipse ellipse = Ellipse::from_moments(moments.mean, moments.covariance);
    const double diameter = ellipse.diameter() + 1.0;
    if (diameter < level_px.min_px || diameter > level_px.max_px) continue;
    ellipse.axes += 0.5 * Eigen::Matrix2d::Identity();
    ellipse.axes *= scale;
    ellipse.centre = (ellipse.centre.array() + 0.5) * scale - 0.5;
    out.push_back({ellipse, std::min(circularity, 1.0)});
  }
}

}  // namespace

std::vector<CandidateOutline> candidate_outlines(const LumaView& luma, DiameterRange diameters) {
  std::vector<CandidateOutline> out;
  if (width_of(luma) < 8 || height_of(luma) < 8) return out;
  cv::Mat level = eight_bit(luma), smooth;
  for (int i = 0; i < kLevels; ++i) {
    const double scale = std::pow(2.0, i);
    if (i > 0) {
      cv::Mat half;
      const cv::Rect even(0, 0, level.cols / 2 * 2, level.rows / 2 * 2);  // the scale stays exactly 1/2
      cv::resize(level(even), half, cv::Size(level.cols / 2, level.rows / 2), 0, 0, cv::INTER_AREA);
      level = half;
    }
    if (std::min(level.cols, level.rows) < 8 || diameters.max_px / scale < kMinLevelDiameter) break;
    if (diameters.min_px / scale > kMaxLevelDiameter / 2.0) continue;  // the next scale sees all of them
    cv::GaussianBlur(level, smooth, cv::Size(3, 3), 0.0);
    // A quarter of slack: the outline is only thresholded, the size is judged on the sub-pixel one.
    const DiameterRange here{std::max(0.75 * diameters.min_px / scale, kMinLevelDiameter),
                             std::min(1.25 * diameters.max_px / scale, kMaxLevelDiameter)};
    add_outlines(locally_dark(smooth), scale, here, out);
  }
  return out;
}

}  // namespace moiregauge::markers_detail
