// SPDX-License-Identifier: Apache-2.0
// Reference weights: linear response of the fitted homography at a target to errors of the references.
#pragma once

#include <span>
#include <vector>

#include "moiregauge/geometry/homography.h"
#include "moiregauge/units/point.h"

namespace moiregauge::internal {

using BoardExtent = Extent<frame::Board>;

// Returns the root of the sum of squares of three uncertainties, for each axis separately.
[[nodiscard]] BoardExtent hypot3(BoardExtent a, BoardExtent b, BoardExtent c);

// Returns the matrices W_i. A small displacement e_i of reference i, with all else right, moves the computed `target`
// by W_i e_i. Exact to first order for a homography near the identity, and by least squares with more than four
// references.
//
// For four references at (+-a, +-b), each known to s, and the target in the centre:
//
//     u_x = (s/2) sqrt(1 + (a/b)^2),     u_y = (s/2) sqrt(1 + (b/a)^2)
[[nodiscard]] std::vector<Matrix2> reference_weights(std::span<const BoardPoint> references, BoardPoint target);

// Returns the standard uncertainties along x and y at the target, mm, from references with independent u_i (mm, each
// coordinate).
[[nodiscard]] Extent<frame::Board> through_references(std::span<const Matrix2> weights,
                                                      std::span<const Extent<frame::Board>> u);

}  // namespace moiregauge::internal
