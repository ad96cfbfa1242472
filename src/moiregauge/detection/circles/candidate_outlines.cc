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
// Grey levels of 8 bits. A neighbourhood with a smaller range is flat: noise of 5 grey levels has less after smoothing.
constexpr int kMinOutlineContrast = 14;
constexpr double kFilledShare = 0.5;     // share of full scale: an image with a larger range is not stretched (chosen)
constexpr double kMinRangeShare = 0.1;   // relative to full scale: limits the stretching of noise (chosen)
constexpr double kMinLevelDiameter = 5;  // px at the scale of the level: smaller discs have no usable outline
constexpr double kMaxLevelDiameter = 110;  // px at the scale of the level; larger discs are left to coarser levels
constexpr double kMinCircularity = 0.62;   // for the digitised outline; far below 0.84: chain code errs by 5 to 10 %
constexpr double kMinAxisRatio = 0.3;      // relative to the bounding box; an ellipse with W > 0.84 has more than 0.5

// Wraps the view without a copy. cv::Mat has no read-only form; callers must not write to it.
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

// Returns the range of the 4 x 4 means of an 8-bit image. Stops as soon as the range fills the scale. Reads every
// eighth row of tiles first, because a marker is higher than a few rows.
Range range_of_tiles(const cv::Mat& picture) {
  constexpr int kStep = 8;
  // Rounds halves to even, as cv::resize does.
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

// Returns the range of the 4 x 4 means: hot pixels do not change it, small discs do.
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

// Returns the image in 8 bits, stretched so that thresholds mean the same for every bit depth and exposure.
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

// Returns the length in px of an 8-connected outline by chain code: 0.948 per straight and 1.340 per diagonal step.
// These weights are unbiased over all directions (Proffitt and Rosen 1979).
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

// Returns the area moments of the polygon through the pixel centres (Green's theorem).
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
  cv::Point start;  // px of the level, the first pixel in row order
  CandidateOutline candidate;
};

// Returns the ellipse of an outline in px of the full-size image. Empty if it is too long, too ragged or has another
// size.
std::optional<CandidateOutline> candidate_of(const std::vector<cv::Point>& outline, double scale,
                                             DiameterRange level_px) {
  const auto n = static_cast<double>(outline.size());
  // A digitised circle has about 2.83 outline pixels per px of diameter, an ellipse or a ragged circle up to twice
  // that.
  if (n < 2.0 * level_px.min_px || n > 6.0 * level_px.max_px) return std::nullopt;
  const cv::Rect box = cv::boundingRect(outline);
  if (std::min(box.width, box.height) < kMinAxisRatio * std::max(box.width, box.height)) return std::nullopt;
  const Moments moments = moments_of(outline);
  if (moments.area <= 0.0) return std::nullopt;
  // The polygon through pixel centres is half a pixel inside (outer outline) or outside (hole) the true edge. W uses
  // area and length of that same polygon.
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

// Adds the outlines of one level, lowest in the image first. This is OpenCV's order for the whole image. Only the
// first of two candidates at one position is fitted, so this order makes the result independent of the parts.
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
  Image<std::uint8_t> here;
  for (int i = 0; i < kOutlineLevels; ++i) {
    const double scale = std::pow(2.0, i);
    Image<std::uint8_t> half;
    if (std::min(level.width, level.height) < 8 || diameters.max_px / scale < kMinLevelDiameter) break;
    if (diameters.min_px / scale > kMaxLevelDiameter / 2.0) {  // the next level covers the whole range
      half = halved(level);
    } else {
      const TileThresholds thresholds =
          tile_thresholds(level, kMinOutlineContrast, i + 1 < kOutlineLevels ? &half : nullptr);
      // 25 % of slack for the thresholded outline. The limits apply to the sub-pixel outline later.
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
