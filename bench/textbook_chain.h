// SPDX-License-Identifier: Apache-2.0
// The yardstick: the seed paper's chain (its Fig. 5) as an engineer writes it with OpenCV, full frame after full frame.
// It shares nothing with ours.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

namespace moiregauge::internal::bench {

// Windows in the reference frame, px. Circles and references go upper left, upper right, lower left, lower right.
struct TextbookSite {
  std::array<cv::Rect, 4> references;
  cv::Rect target;
  double disc_px = 0.0;   // diameter of the circles
  double pitch_px = 0.0;  // P
  double mm_per_px = 0.0;
  int sampling_pitch_px = 31;  // T, seed paper 3.1
};

class TextbookChain {
 public:
  // fails (empty) when the four circles are not found in the reference frame
  [[nodiscard]] static std::optional<TextbookChain> make(const cv::Mat& reference_frame, const TextbookSite& site);

  // Of the target since the reference frame, mm, x right, y up; empty when the four circles are not found.
  [[nodiscard]] std::optional<cv::Point2d> displacement_mm(const cv::Mat& frame) const;

 private:
  using Fringe = std::vector<cv::Point2f>;  // complex
  struct Patch {
    cv::Rect window;
    Fringe along_x, along_y;
  };
  explicit TextbookChain(const TextbookSite& site) : site_(site) {}
  [[nodiscard]] Fringe sampling_moire(const cv::Mat& patch) const;
  [[nodiscard]] Patch read(const cv::Mat& picture, const cv::Rect& window) const;
  [[nodiscard]] cv::Point2f moved_px(const cv::Mat& picture, const Patch& then) const;

  TextbookSite site_;
  std::array<cv::Point2f, 4> circles_;
  std::array<Patch, 4> references_;
  Patch target_;
};

// Otsu's threshold, outlines, area, circularity, moments. Empty unless exactly four are found.
[[nodiscard]] std::optional<std::array<cv::Point2f, 4>> textbook_circles(const cv::Mat& frame, double disc_px);

}  // namespace moiregauge::internal::bench
