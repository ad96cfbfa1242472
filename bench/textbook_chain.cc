// SPDX-License-Identifier: Apache-2.0
#include "textbook_chain.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include <opencv2/imgproc.hpp>

namespace moiregauge::internal::bench {
namespace {

constexpr double kMinCircularity = 0.84;  // W, paper Eq. (6)
constexpr double kTwoPi = 2.0 * CV_PI;

// Returns the displacement in pitches: minus the phase change averaged over the patch (paper Eq. 4).
double moved_pitches(const std::vector<cv::Point2f>& then, const std::vector<cv::Point2f>& now) {
  std::complex<double> sum;
  for (std::size_t i = 0; i < now.size(); ++i)
    sum += std::complex<double>(now[i].x, now[i].y) * std::conj(std::complex<double>(then[i].x, then[i].y));
  return -std::arg(sum) / kTwoPi;
}

}  // namespace

std::optional<std::array<cv::Point2f, 4>> textbook_circles(const cv::Mat& frame, double disc_px) {
  cv::Mat binary;
  cv::threshold(frame, binary, 0, 255, cv::THRESH_BINARY_INV | cv::THRESH_OTSU);
  std::vector<std::vector<cv::Point>> outlines;
  cv::findContours(binary, outlines, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
  const double disc_area = 0.25 * CV_PI * disc_px * disc_px;
  std::vector<cv::Point2f> found;
  for (const auto& outline : outlines) {
    const double area = cv::contourArea(outline);
    if (area < 0.5 * disc_area || area > 2.0 * disc_area) continue;
    const double length = cv::arcLength(outline, true);
    if (4.0 * CV_PI * area < kMinCircularity * length * length) continue;
    const cv::Moments m = cv::moments(outline);
    found.emplace_back(static_cast<float>(m.m10 / m.m00), static_cast<float>(m.m01 / m.m00));
  }
  if (found.size() != 4) return std::nullopt;
  std::sort(found.begin(), found.end(), [](auto a, auto b) { return a.y < b.y; });
  if (found[0].x > found[1].x) std::swap(found[0], found[1]);
  if (found[2].x > found[3].x) std::swap(found[2], found[3]);
  return std::array{found[0], found[1], found[2], found[3]};
}

// Computes sampling moire along the rows (paper Eqs. 2 and 3): T images of every T-th pixel, interpolated linearly, and
// their DFT at 1/T. Pixel x of the image that begins at pixel k is between x - j and x - j + T, with j = (x - k) mod T.
TextbookChain::Fringe TextbookChain::sampling_moire(const cv::Mat& patch) const {
  const int pitch = site_.sampling_pitch_px, width = patch.cols - 2 * pitch;
  std::vector<float> cosine(static_cast<std::size_t>(patch.cols)), sine(cosine.size());
  for (std::size_t i = 0; i < cosine.size(); ++i) {
    cosine[i] = static_cast<float>(std::cos(kTwoPi * static_cast<double>(i) / pitch));
    sine[i] = static_cast<float>(-std::sin(kTwoPi * static_cast<double>(i) / pitch));
  }
  std::vector<float> re(static_cast<std::size_t>(width)), im(re.size());
  Fringe fringe;
  for (int y = 0; y < patch.rows; ++y) {
    std::fill(re.begin(), re.end(), 0.0F);
    std::fill(im.begin(), im.end(), 0.0F);
    for (int j = 0; j < pitch; ++j) {
      const float right = static_cast<float>(j) / static_cast<float>(pitch), left = 1.0F - right;
      const float* grey = patch.ptr<float>(y) + pitch - j;
      const float* c = cosine.data() + pitch - j;
      const float* s = sine.data() + pitch - j;
      for (int x = 0; x < width; ++x) {
        const float between = left * grey[x] + right * grey[x + pitch];
        re[static_cast<std::size_t>(x)] += between * c[x];
        im[static_cast<std::size_t>(x)] += between * s[x];
      }
    }
    for (std::size_t x = 0; x < re.size(); ++x) fringe.emplace_back(re[x], im[x]);
  }
  return fringe;
}

TextbookChain::Patch TextbookChain::read(const cv::Mat& picture, const cv::Rect& window) const {
  cv::Mat patch, turned;
  picture(window).convertTo(patch, CV_32F);
  cv::transpose(patch, turned);
  return {window, sampling_moire(patch), sampling_moire(turned)};
}

cv::Point2f TextbookChain::moved_px(const cv::Mat& picture, const Patch& then) const {
  const Patch now = read(picture, then.window);
  return {static_cast<float>(site_.pitch_px * moved_pitches(then.along_x, now.along_x)),
          static_cast<float>(site_.pitch_px * moved_pitches(then.along_y, now.along_y))};
}

std::optional<TextbookChain> TextbookChain::make(const cv::Mat& reference_frame, const TextbookSite& site) {
  TextbookChain chain(site);
  const auto circles = textbook_circles(reference_frame, site.disc_px);
  if (!circles) return std::nullopt;
  chain.circles_ = *circles;
  for (std::size_t i = 0; i < 4; ++i) chain.references_[i] = chain.read(reference_frame, site.references[i]);
  chain.target_ = chain.read(reference_frame, site.target);
  return chain;
}

std::optional<cv::Point2d> TextbookChain::displacement_mm(const cv::Mat& frame) const {
  const auto circles = textbook_circles(frame, site_.disc_px);
  if (!circles) return std::nullopt;
  const cv::Mat first = cv::getPerspectiveTransform(circles->data(), circles_.data());
  cv::Mat warped;
  cv::warpPerspective(frame, warped, first, frame.size(), cv::INTER_LINEAR);
  std::array<cv::Point2f, 4> refined;
  for (std::size_t i = 0; i < 4; ++i) refined[i] = circles_[i] + moved_px(warped, references_[i]);
  const cv::Mat second = cv::getPerspectiveTransform(refined.data(), circles_.data());
  cv::warpPerspective(frame, warped, second * first, frame.size(), cv::INTER_LINEAR);
  const cv::Point2d moved = moved_px(warped, target_);
  return cv::Point2d(site_.mm_per_px * moved.x, -site_.mm_per_px * moved.y);
}

}  // namespace moiregauge::internal::bench
