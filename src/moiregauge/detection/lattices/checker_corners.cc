// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/lattices/checker_corners.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <optional>

#include <Eigen/LU>
#include <opencv2/imgproc.hpp>

#include "moiregauge/units/units.h"

namespace moiregauge::internal::markers_detail {
namespace {

constexpr int kCornerLevels = 4;                   // scales 1, 1/2, 1/4, 1/8: edges blurred over up to 20 px
constexpr double kSmoothing = 1.0;                 // px at the scale of the level, sigma
constexpr double kMinCornerContrast = 10.0;        // grey levels of 8 bits, light minus dark (chosen)
constexpr std::array<double, 2> kRings{5.0, 3.0};  // px at the scale of the level, radius: 3 px for small squares
constexpr int kOnRing = 32;                        // samples per ring
constexpr double kMinEven = 0.8;                   // share of the ring's variance that is point-symmetric (chosen)
// Smallest share of the ring's variance in the second harmonic. Four equal sharp sectors have 8 / pi^2 = 0.81.
constexpr double kMinSecond = 0.6;
constexpr double kSamePlace = 3.0;  // px at the scale of the level

cv::Mat as_float(const LumaView& luma, double scale) {
  return std::visit(
      [&](const auto& view) {
        const int type = sizeof(view.data[0]) == 1 ? CV_8U : CV_16U;
        // cv::Mat has no read-only form; convertTo only reads.
        void* pixels = const_cast<void*>(static_cast<const void*>(view.data));
        cv::Mat out;
        cv::Mat(view.height, view.width, type, pixels, static_cast<std::size_t>(view.stride) * sizeof(view.data[0]))
            .convertTo(out, CV_32F, scale);
        return out;
      },
      luma);
}

double bilinear(const cv::Mat& level, double x, double y) {
  const int ix = static_cast<int>(x), iy = static_cast<int>(y);
  const double fx = x - ix, fy = y - iy;
  const float* p = level.ptr<float>(iy) + ix;
  const float* q = level.ptr<float>(iy + 1) + ix;
  const double top = static_cast<double>(p[0]) + fx * static_cast<double>(p[1] - p[0]);
  const double low = static_cast<double>(q[0]) + fx * static_cast<double>(q[1] - q[0]);
  return top + fy * (low - top);
}

struct Sectors {
  double light_rad = 0.0;
  double contrast = 0.0;
};

// Returns direction and contrast of the sectors on a ring. Empty unless opposite sides are alike and two of four
// sectors are light.
std::optional<Sectors> sectors_round(const cv::Mat& level, const Eigen::Vector2d& at, double radius) {
  if (at.x() < radius || at.y() < radius || at.x() > level.cols - 2 - radius || at.y() > level.rows - 2 - radius)
    return std::nullopt;
  std::array<double, kOnRing> grey{};
  double mean = 0.0;
  for (int i = 0; i < kOnRing; ++i) {
    const double angle = kTwoPi * i / kOnRing;
    grey[static_cast<std::size_t>(i)] =
        bilinear(level, at.x() + radius * std::cos(angle), at.y() + radius * std::sin(angle));
    mean += grey[static_cast<std::size_t>(i)] / kOnRing;
  }
  double variance = 0.0, even = 0.0;
  std::complex<double> second = 0.0;
  for (std::size_t i = 0; i < kOnRing; ++i) {
    const double here = grey[i] - mean, opposite = grey[(i + kOnRing / 2) % kOnRing] - mean;
    variance += here * here / kOnRing;
    even += 0.25 * (here + opposite) * (here + opposite) / kOnRing;
    second += here * std::polar(2.0 / kOnRing, -2.0 * kTwoPi * static_cast<double>(i) / kOnRing);
  }
  const double contrast = 2.0 * std::sqrt(variance);
  if (contrast < kMinCornerContrast || even < kMinEven * variance || 0.5 * std::norm(second) < kMinSecond * variance)
    return std::nullopt;
  return Sectors{-std::arg(second), contrast};
}

// Returns the saddle point of the local quadratic in px from the pixel. Empty if it is no saddle or is beyond 1.5 px.
std::optional<Eigen::Vector2d> saddle_of(const cv::Mat& level, int x, int y) {
  const auto at = [&](int dx, int dy) { return static_cast<double>(level.at<float>(y + dy, x + dx)); };
  const Eigen::Vector2d slope(0.5 * (at(1, 0) - at(-1, 0)), 0.5 * (at(0, 1) - at(0, -1)));
  Eigen::Matrix2d bend;
  bend(0, 0) = at(1, 0) - 2.0 * at(0, 0) + at(-1, 0);
  bend(1, 1) = at(0, 1) - 2.0 * at(0, 0) + at(0, -1);
  bend(0, 1) = bend(1, 0) = 0.25 * (at(1, 1) - at(-1, 1) - at(1, -1) + at(-1, -1));
  if (bend.determinant() >= 0.0) return std::nullopt;
  const Eigen::Vector2d off = -bend.inverse() * slope;
  if (off.norm() > 1.5) return std::nullopt;
  return off;
}

// Returns Ixy^2 - Ixx Iyy for all pixels: large at saddles, negative on extremes, 0 on edges.
cv::Mat saddleness(const cv::Mat& level) {
  cv::Mat xx, yy, xy;
  cv::Sobel(level, xx, CV_32F, 2, 0, 3, 0.25);
  cv::Sobel(level, yy, CV_32F, 0, 2, 3, 0.25);
  cv::Sobel(level, xy, CV_32F, 1, 1, 3, 0.25);
  return xy.mul(xy) - xx.mul(yy);
}

void add_corners(const cv::Mat& level, double scale, std::vector<CheckerCorner>& out) {
  const cv::Mat response = saddleness(level);
  cv::Mat highest;
  cv::dilate(response, highest, cv::Mat::ones(5, 5, CV_8U));
  // A saddle between sharp squares has a response of about (contrast / (pi sigma^2))^2, blurred ones have less.
  const double threshold = std::pow(0.1 * kMinCornerContrast, 2.0);
  const std::size_t finer = out.size();
  for (int y = 4; y + 4 < level.rows; ++y) {
    const float* here = response.ptr<float>(y);
    const float* most = highest.ptr<float>(y);
    for (int x = 4; x + 4 < level.cols; ++x) {
      if (here[x] < most[x] || static_cast<double>(here[x]) < threshold) continue;
      const auto off = saddle_of(level, x, y);
      if (!off) continue;
      const Eigen::Vector2d at = Eigen::Vector2d(x, y) + *off;
      std::optional<Sectors> sectors;
      for (const double radius : kRings) {
        if (!sectors) sectors = sectors_round(level, at, radius);
      }
      if (!sectors) continue;
      const Eigen::Vector2d place = (at.array() + 0.5) * scale - 0.5;
      const auto same = [&](const CheckerCorner& c) { return (c.at - place).norm() < kSamePlace * scale; };
      if (std::any_of(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(finer), same)) continue;
      out.push_back({place, sectors->light_rad, sectors->contrast});
    }
  }
}

}  // namespace

std::vector<CheckerCorner> find_checker_corners(const LumaView& luma, int bits) {
  std::vector<CheckerCorner> out;
  const double to_eight_bits = 255.0 / (std::pow(2.0, bits) - 1.0);
  cv::Mat level = as_float(luma, to_eight_bits), smooth;
  for (int i = 0; i < kCornerLevels; ++i) {
    if (i > 0) {
      cv::Mat half;
      const cv::Rect even(0, 0, level.cols / 2 * 2, level.rows / 2 * 2);  // keeps the scale at exactly 1/2
      cv::resize(level(even), half, cv::Size(level.cols / 2, level.rows / 2), 0, 0, cv::INTER_AREA);
      level = half;
    }
    if (std::min(level.cols, level.rows) < 16) break;
    cv::GaussianBlur(level, smooth, cv::Size(0, 0), kSmoothing);
    add_corners(smooth, std::pow(2.0, i), out);
  }
  for (CheckerCorner& corner : out) corner.contrast /= to_eight_bits;
  return out;
}

}  // namespace moiregauge::internal::markers_detail
