// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/circles/candidate_outlines.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "moiregauge/detection/circles/adaptive_threshold.h"

namespace moiregauge::internal::markers_detail {
namespace {

constexpr int kOutlineLevels = 4;  // scales 1, 1/2, 1/4, 1/8: neighbourhoods of 12, 24, 48 and 96 px
// Of 255: below it a neighbourhood is flat; more than the range of 5 DN noise, smoothed.
constexpr int kMinOutlineContrast = 14;
constexpr double kFilledShare = 0.5;     // of full scale: a picture of more range is not stretched
constexpr double kMinRangeShare = 0.1;   // of full scale: a picture of less range is not stretched further (noise)
constexpr double kMinLevelDiameter = 5;  // px of a level: fewer do not make an outline
constexpr double kMaxLevelDiameter = 110;
constexpr double kMinCircularity = 0.62;  // of the digitised outline; far below 0.84 since chain code errs by 5 - 10 %
constexpr double kMinAxisRatio = 0.3;     // rounder than any circle W > 0.84 can pass (0.5)

// cv::Mat has no read-only form; it is only read here.
template <typename Grey>
cv::Mat mat_of(const ImageView<Grey>& view) {
  void* pixels = const_cast<void*>(static_cast<const void*>(view.data));
  return cv::Mat(view.height, view.width, sizeof(Grey) == 1 ? CV_8U : CV_16U, pixels,
                 static_cast<std::size_t>(view.stride) * sizeof(Grey));
}

GreyView view_of(const cv::Mat& picture) {
  return {picture.data, picture.cols, picture.rows, static_cast<std::ptrdiff_t>(picture.step)};
}

struct Range {
  double low = 0.0, high = 0.0;
  [[nodiscard]] bool fills(double scale) const { return high - low > kFilledShare * scale; }
};

// Of whole 4 x 4 means in 8 bits, and of no more of them than it takes to see that they fill the scale: all over the
// picture first, as a marker is higher than a few rows.
Range range_of_tiles(const cv::Mat& picture) {
  constexpr int kStep = 8;
  // Halves to the even side, as cv::resize has them.
  const auto mean = [](int sum) { return (sum + 7 + (sum >> 4) % 2) >> 4; };
  const int rows = picture.rows / kTilePx;
  TileSums sums;
  Range range{255.0, 0.0};
  for (int first = 0; first < kStep; ++first) {
    for (int y = first; y < rows && !range.fills(255.0); y += kStep) {
      tile_row_sums(view_of(picture), y, sums);
      range = {static_cast<double>(mean(sums.smallest)), static_cast<double>(mean(sums.largest))};
    }
  }
  return range;
}

// That of 4 x 4 means, so that hot pixels have no say and a few small dark discs do.
Range range_of(const cv::Mat& picture) {
  if (picture.depth() == CV_8U && picture.cols % kTilePx == 0 && picture.rows % kTilePx == 0)
    return range_of_tiles(picture);
  cv::Mat coarse;
  const cv::Size size(std::max(1, picture.cols / kTilePx), std::max(1, picture.rows / kTilePx));
  cv::resize(picture, coarse, size, 0, 0, cv::INTER_AREA);
  Range range;
  cv::minMaxLoc(coarse, &range.low, &range.high);
  return range;
}

// The picture in 8 bits, stretched so that its range counts whatever its depth.
cv::Mat eight_bit(const cv::Mat& picture) {
  const Range range = range_of(picture);
  const double full = picture.depth() == CV_8U ? 255.0 : std::max(1023.0, range.high);
  if (picture.depth() == CV_8U && range.fills(full)) return picture;
  const double stretched = std::max(range.high - range.low, kMinRangeShare * full);
  cv::Mat out;
  picture.convertTo(out, CV_8U, 240.0 / stretched, 8.0 - range.low * 240.0 / stretched);
  return out;
}

cv::Mat eight_bit(const LumaView& luma) {
  return std::visit([](const auto& view) { return eight_bit(mat_of(view)); }, luma);
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

struct LevelOutline {
  cv::Point start;  // its first pixel, rows from top to bottom
  CandidateOutline candidate;
};

// Empty: hopelessly long or ragged, or of another size.
std::optional<CandidateOutline> candidate_of(const std::vector<cv::Point>& outline, double scale,
                                             DiameterRange level_px) {
  const auto n = static_cast<double>(outline.size());
  // A digitised circle has about 2.83 outline pixels per pixel of diameter, an ellipse or a ragged circle up to twice.
  if (n < 2.0 * level_px.min_px || n > 6.0 * level_px.max_px) return std::nullopt;
  const cv::Rect box = cv::boundingRect(outline);
  if (std::min(box.width, box.height) < kMinAxisRatio * std::max(box.width, box.height)) return std::nullopt;
  const Moments moments = moments_of(outline);
  if (moments.area <= 0.0) return std::nullopt;
  // The polygon runs through pixel centres, so half a pixel inside (outer outline) or outside (hole) the true edge: W
  // is computed of the polygon itself, whose length the chain code gives.
  const double length = chain_length(outline);
  const double circularity = 4.0 * CV_PI * moments.area / (length * length);
  if (circularity < kMinCircularity) return std::nullopt;
  Ellipse ellipse = Ellipse::from_moments(moments.mean, moments.covariance);
  const double diameter = ellipse.diameter() + 1.0;
  if (diameter < level_px.min_px || diameter > level_px.max_px) return std::nullopt;
  ellipse.axes += 0.5 * Eigen::Matrix2d::Identity();
  ellipse.axes *= scale;
  ellipse.centre = (ellipse.centre.array() + 0.5) * scale - 0.5;
  return CandidateOutline{ellipse, std::min(circularity, 1.0)};
}

// Lowest first, as the outlines of the whole picture at once would come: of two candidates at one place the first is
// the one that is fitted, whatever parts the picture fell into.
void add_outlines(const GreyView& level, const TileThresholds& thresholds, double scale, DiameterRange level_px,
                  std::vector<CandidateOutline>& out) {
  std::vector<LevelOutline> found;
  std::vector<std::vector<cv::Point>> outlines;
  std::vector<std::uint8_t> memory;
  for (const PicturePart& part : thresholds.parts) {
    const cv::Mat dark = mat_of(dark_part(level, thresholds, part, memory));
    cv::findContours(dark, outlines, cv::RETR_LIST, cv::CHAIN_APPROX_NONE, cv::Point(part.x, part.y));
    for (const auto& outline : outlines) {
      if (auto candidate = candidate_of(outline, scale, level_px)) found.push_back({outline.front(), *candidate});
    }
  }
  std::sort(found.begin(), found.end(), [](const LevelOutline& a, const LevelOutline& b) {
    return std::pair(a.start.y, a.start.x) > std::pair(b.start.y, b.start.x);
  });
  for (const LevelOutline& outline : found) out.push_back(outline.candidate);
}

}  // namespace

std::vector<CandidateOutline> candidate_outlines(const LumaView& luma, DiameterRange diameters) {
  std::vector<CandidateOutline> out;
  if (width_of(luma) < 8 || height_of(luma) < 8) return out;
  const cv::Mat finest = eight_bit(luma);
  GreyView level = view_of(finest);
  Image<std::uint8_t> here, half;
  for (int i = 0; i < kOutlineLevels; ++i) {
    const double scale = std::pow(2.0, i);
    if (std::min(level.width, level.height) < 8 || diameters.max_px / scale < kMinLevelDiameter) break;
    if (diameters.min_px / scale > kMaxLevelDiameter / 2.0) {  // the next scale sees all of them
      half = halved(level);
    } else {
      const TileThresholds thresholds =
          tile_thresholds(level, kMinOutlineContrast, i + 1 < kOutlineLevels ? &half : nullptr);
      // A quarter of slack: the outline is only thresholded, the size is judged on the sub-pixel one.
      const DiameterRange sizes{std::max(0.75 * diameters.min_px / scale, kMinLevelDiameter),
                                std::min(1.25 * diameters.max_px / scale, kMaxLevelDiameter)};
      add_outlines(level, thresholds, scale, sizes, out);
    }
    here = std::move(half);
    level = here.view();
  }
  return out;
}

}  // namespace moiregauge::internal::markers_detail
