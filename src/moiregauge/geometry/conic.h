// SPDX-License-Identifier: Apache-2.0
// A circle seen through a homography is an ellipse, and the ellipse's centre is not the image of the circle's centre.
#pragma once

#include "moiregauge/geometry/homography.h"

namespace moiregauge::internal {

// Centre of the ellipse into which `image_from_board` maps a circle; exact.
// The offset from image_from_board(centre) is about r^2 sin(theta) cos(theta) f / Z^2 px at tilt theta (METHOD: 0.03 px at
// 8 deg, 0.08 px at 20 deg on the paper's rig).
template <typename To>
[[nodiscard]] Point<To> ellipse_centre(const Homography<To, frame::Board>& image_from_board, BoardPoint centre,
                                       double diameter_mm) {
  const double r = 0.5 * diameter_mm;
  // Dual conic of the circle (lines tangent to it): point conics map by H^-T C H^-1, dual ones by H C* H^T, and the
  // centre is the pole of the line at infinity: C* (0,0,1)^T.
  Matrix3 dual;
  dual << r * r - centre.x * centre.x, -centre.x * centre.y, -centre.x,  //
      -centre.x * centre.y, r * r - centre.y * centre.y, -centre.y,      //
      -centre.x, -centre.y, -1.0;
  const Matrix3& h = image_from_board.matrix();
  const Eigen::Vector3d pole = h * dual * h.transpose().col(2);
  return {pole.x() / pole.z(), pole.y() / pole.z()};
}

}  // namespace moiregauge::internal
