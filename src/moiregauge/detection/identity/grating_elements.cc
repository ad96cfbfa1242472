// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/identity/grating_elements.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Dense>

namespace moiregauge::internal {
namespace {

constexpr double kCautious = 0.5;     // pitches that a grating may extend beyond its patch's outline
constexpr double kElementStep = 0.2;  // pitches from the predicted neighbour: lens and tilt change little in one pitch
constexpr double kOneElement = 0.2;   // largest relative difference of the diameters of neighbours

// Returns the steps of one pitch along the grating's x and y, in px.
std::array<ImageExtent, 2> steps_of(const DetectedPatch& patch) {
  Eigen::Matrix2d k;
  k << patch.k_x.x, patch.k_x.y, patch.k_y.x, patch.k_y.y;
  const Eigen::Matrix2d px = k.inverse();
  return {ImageExtent{px(0, 0), px(1, 0)}, ImageExtent{px(0, 1), px(1, 1)}};
}

// Marks the circles inside the patch, and repeatedly all neighbours one pitch away from a marked circle.
void mark(const DetectedPatch& patch, std::span<const DetectedCircle> circles, std::vector<bool>& is_element) {
  const auto steps = steps_of(patch);
  const double pitch_px = 0.5 * (length(steps[0]) + length(steps[1]));
  std::vector<std::size_t> open;
  const auto take = [&](std::size_t i) {
    is_element[i] = true;
    open.push_back(i);
  };
  for (std::size_t i = 0; i < circles.size(); ++i) {
    if (!is_element[i] && distance_px(patch, circles[i].centre) < kCautious * pitch_px) take(i);
  }
  while (!open.empty()) {
    const DetectedCircle& from = circles[open.back()];
    open.pop_back();
    for (int n = 0; n < 4; ++n) {
      const ImagePoint there = from.centre + (n % 2 == 0 ? 1.0 : -1.0) * steps[static_cast<std::size_t>(n / 2)];
      for (std::size_t i = 0; i < circles.size(); ++i) {
        if (is_element[i] || length(circles[i].centre - there) > kElementStep * pitch_px) continue;
        if (std::abs(std::log(circles[i].diameter_px / from.diameter_px)) < kOneElement) take(i);
      }
    }
  }
}

}  // namespace

std::vector<DetectedCircle> without_elements(std::span<const DetectedCircle> circles,
                                             std::span<const DetectedPatch> patches) {
  std::vector<bool> is_element(circles.size(), false);
  for (const DetectedPatch& patch : patches) mark(patch, circles, is_element);
  std::vector<DetectedCircle> out;
  for (std::size_t i = 0; i < circles.size(); ++i) {
    if (!is_element[i]) out.push_back(circles[i]);
  }
  return out;
}

}  // namespace moiregauge::internal
