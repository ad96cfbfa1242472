// SPDX-License-Identifier: Apache-2.0
// Reference implementation: the paper's chain (Fig. 5) as an engineer writes it with OpenCV, on full frames. It shares
// no code with our methods.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

namespace moiregauge::internal::bench {

// Windows in the reference frame, px. The order is upper left, upper right, lower left, lower right.
struct TextbookSite {
  std::array<cv::Rect, 4> references;
  cv::Rect target;
  double disc_px = 0.0;        // px, diameter of the circles
  double pitch_px = 0.0;       // px, P of the paper
  double mm_per_px = 0.0;      // mm per px
  int sampling_pitch_px = 31;  // px, T of the paper, section 3.1
};

class TextbookChain {
 public:
  // Prepares the chain. Empty if the four circles are not found in the reference frame.
  [[nodiscard]] static std::optional<TextbookChain> make(const cv::Mat& reference_frame, const TextbookSite& site);

  // Returns the target's displacement since the reference frame in mm, x right, y up. Empty if a circle is not found.
  [[nodiscard]] std::optional<cv::Point2d> displacement_mm(const cv::Mat& frame) const;

 private:
  using Fringe = std::vector<cv::Point2f>;  // complex numbers
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

// Detects the circles by Otsu's threshold, outlines, area, circularity and moments. Empty unless exactly four are
// found.
[[nodiscard]] std::optional<std::array<cv::Point2f, 4>> textbook_circles(const cv::Mat& frame, double disc_px);

}  // namespace moiregauge::internal::bench
