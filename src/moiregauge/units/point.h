// SPDX-License-Identifier: Apache-2.0
// Points with their frame of reference as a type, so that a board point cannot be used as an image point.
#pragma once

#include <cmath>

namespace moiregauge::internal {

namespace frame {
struct Image;  // px, the image as displayed: (0,0) is the centre of the top-left pixel, x right, y down
struct Ideal;  // px, the same image through a lens without distortion
struct Board;  // mm, the board's plane: x right, y up, z towards the camera
}  // namespace frame

// Difference of two points of one frame.
template <typename Frame>
struct Extent {
  double x = 0.0;
  double y = 0.0;
  friend constexpr Extent operator+(Extent a, Extent b) { return {a.x + b.x, a.y + b.y}; }
  friend constexpr Extent operator-(Extent a, Extent b) { return {a.x - b.x, a.y - b.y}; }
  friend constexpr Extent operator*(double s, Extent a) { return {s * a.x, s * a.y}; }
};

template <typename Frame>
struct Point {
  double x = 0.0;
  double y = 0.0;
  friend constexpr Extent<Frame> operator-(Point a, Point b) { return {a.x - b.x, a.y - b.y}; }
  friend constexpr Point operator+(Point a, Extent<Frame> d) { return {a.x + d.x, a.y + d.y}; }
};

template <typename Frame>
[[nodiscard]] inline double length(Extent<Frame> d) {
  return std::hypot(d.x, d.y);
}

using ImagePoint = Point<frame::Image>;
using IdealPoint = Point<frame::Ideal>;
using BoardPoint = Point<frame::Board>;

}  // namespace moiregauge::internal
