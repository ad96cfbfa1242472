// SPDX-License-Identifier: Apache-2.0
// Pinhole camera with OpenCV's five-term lens model (docs.opencv.org, calib3d), in pixels. Camera axes: x right, y
// down, z forward.
//
//     x = X/Z, y = Y/Z, r^2 = x^2 + y^2, radial = 1 + k1 r^2 + k2 r^4 + k3 r^6
//     xd = x radial + 2 p1 x y + p2 (r^2 + 2 x^2),  yd = y radial + p1 (r^2 + 2 y^2) + 2 p2 x y
//     u = fx xd + cx,  v = fy yd + cy
#pragma once

#include <optional>

#include "moiregauge/units/point.h"

namespace moiregauge::internal {

struct Camera {
  int width = 0;  // px; 0: not stated
  int height = 0;
  double fx = 1.0, fy = 1.0, cx = 0.0, cy = 0.0;
  double k1 = 0.0, k2 = 0.0, p1 = 0.0, p2 = 0.0, k3 = 0.0;

  // Returns the distorted image point of an ideal one (px, same fx fy cx cy).
  [[nodiscard]] ImagePoint distort(IdealPoint ideal) const;
  // Returns the ideal point by Newton iteration, px. Exact to 1e-12 px within the model's monotone range.
  [[nodiscard]] IdealPoint undistort(ImagePoint seen) const;
  // Returns the distance from the principal point at which the radial model folds, px in the image. Beyond it the lens
  // has no inverse. Empty: no fold inside the image (width and height must be stated).
  [[nodiscard]] std::optional<double> fold_px() const;
  [[nodiscard]] bool is_distortion_free() const { return k1 == 0 && k2 == 0 && p1 == 0 && p2 == 0 && k3 == 0; }
};

}  // namespace moiregauge::internal
