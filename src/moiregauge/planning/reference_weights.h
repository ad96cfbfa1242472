// SPDX-License-Identifier: Apache-2.0
// What a layout of references does to a target between them: the linear response of the fitted homography.
#pragma once

#include <span>
#include <vector>

#include "moiregauge/geometry/homography.h"
#include "moiregauge/units/point.h"

namespace moiregauge::internal {

using BoardExtent = Extent<frame::Board>;

// Returns the root of the sum of squares of three uncertainties, each axis by itself.
[[nodiscard]] BoardExtent hypot3(BoardExtent a, BoardExtent b, BoardExtent c);

// W_i: a small displacement e_i of reference i (all else right) moves the homography's idea of `target` by W_i e_i.
// Exact to first order for a homography near the identity, by least squares when there are more than four references.
// Closed form, four references at (+-a, +-b), target in the centre: u_x = (s/2) sqrt(1 + (a/b)^2), u_y = (s/2) sqrt(1 +
// (b/a)^2).
[[nodiscard]] std::vector<Matrix2> reference_weights(std::span<const BoardPoint> references, BoardPoint target);

// Standard uncertainties along x and y at the target from references known to u_i (mm, each coordinate).
[[nodiscard]] Extent<frame::Board> through_references(std::span<const Matrix2> weights,
                                                      std::span<const Extent<frame::Board>> u);

}  // namespace moiregauge::internal
