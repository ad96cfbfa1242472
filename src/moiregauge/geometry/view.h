// SPDX-License-Identifier: Apache-2.0
// View of the board in one frame: a homography to ideal pixels, then the lens.
#pragma once

#include <algorithm>
#include <cmath>

#include "moiregauge/geometry/camera.h"
#include "moiregauge/geometry/homography.h"

namespace moiregauge::internal {

using IdealFromBoard = Homography<frame::Ideal, frame::Board>;

struct View {
  IdealFromBoard ideal_from_board;
  Camera lens;  // if it has no distortion, ideal and seen pixels are the same

  [[nodiscard]] ImagePoint operator()(BoardPoint p) const {
    const IdealPoint ideal = ideal_from_board(p);
    return lens.is_distortion_free() ? ImagePoint{ideal.x, ideal.y} : lens.distort(ideal);
  }
  [[nodiscard]] BoardPoint board(ImagePoint p) const { return ideal_from_board.inverse()(lens.undistort(p)); }
  // Returns the geometric mean over directions of board millimetres per image pixel at p, without the lens's own scale.
  [[nodiscard]] double mm_per_px(BoardPoint p) const {
    return 1.0 / std::sqrt(std::abs(ideal_from_board.jacobian(p).determinant()));
  }
  // Returns the same in the direction in which a pixel covers least of the board.
  [[nodiscard]] double finest_mm_per_px(BoardPoint p) const {
    const Matrix2 j = ideal_from_board.jacobian(p);
    const double sum = 0.5 * j.squaredNorm(), det = j.determinant();  // half the sum of the squared singular values
    return 1.0 / std::sqrt(sum + std::sqrt(std::max(0.0, sum * sum - det * det)));
  }
};

}  // namespace moiregauge::internal
