// SPDX-License-Identifier: Apache-2.0
// A circle seen through a homography is an ellipse. The centre of the ellipse is not the image of the circle's centre.
#pragma once

#include "moiregauge/geometry/homography.h"

namespace moiregauge::internal {

// Returns the centre of the ellipse into which `image_from_board` maps a circle (exact). Its offset from the image of
// the circle's centre is about r^2 sin(theta) cos(theta) f / Z^2 px at tilt theta. On the paper's rig that is 0.03 px
// at 8 deg and 0.08 px at 20 deg (docs/methods/two-stage.md).
template <typename To>
[[nodiscard]] Point<To> ellipse_centre(const Homography<To, frame::Board>& image_from_board, BoardPoint centre,
                                       double diameter_mm) {
  const double r = 0.5 * diameter_mm;
  // Dual conic of the circle (the lines tangent to it). Point conics map by H^-T C H^-1, dual ones by H C* H^T. The
  // centre is the pole of the line at infinity, C* (0,0,1)^T.
  Matrix3 dual;
  dual << r * r - centre.x * centre.x, -centre.x * centre.y, -centre.x,  //
      -centre.x * centre.y, r * r - centre.y * centre.y, -centre.y,      //
      -centre.x, -centre.y, -1.0;
  const Matrix3& h = image_from_board.matrix();
  const Eigen::Vector3d pole = h * dual * h.transpose().col(2);
  return {pole.x() / pole.z(), pole.y() / pole.z()};
}

}  // namespace moiregauge::internal
