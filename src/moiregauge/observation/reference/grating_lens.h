// SPDX-License-Identifier: Apache-2.0
// Lens that the gratings of the reference frame show by their shear and by how their sizes differ.
#pragma once

#include <optional>

#include "moiregauge/geometry/view.h"

namespace moiregauge::internal {

struct Reference;

// View of the board through the circles and a lens of one radial term.
struct GratingLens {
  View view;          // fx = fy = half the diagonal, so k1 is the distortion at the corner of the image, relative
  double u_k1 = 0.0;  // standard uncertainty (k = 1)
};

// Fits k1, a stretch of all gratings along x and y, and a common shear to the phase gradients of the gratings.
// A wrong pitch has no shear, and wrong circle positions have one that is alike or grows along a line. The shear by a
// lens has the sign of xy. Each target has a scale of its own, because it may be off the plane.
// Fails (nothing): a camera is given, k1 is within three u, or beyond a distortion of 15 %.
[[nodiscard]] std::optional<GratingLens> lens_from_gratings(const Reference& reference, double u_scale);

// Returns the phase gradient that the lens causes at a point, as apparent displacement (mm) per mm. It is against the
// view of the circles without a lens, and along axes that are rotated by `angle_rad`.
[[nodiscard]] Matrix2 gradient_by_lens(const Reference& reference, const View& through_lens, BoardPoint at,
                                       double angle_rad);

}  // namespace moiregauge::internal
