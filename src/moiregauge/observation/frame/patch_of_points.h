// SPDX-License-Identifier: Apache-2.0
// Converts the points of a template fit to a raster reading, with phases relative to the reference frame's. Users of a
// patch then need not know which method read it.
#pragma once

#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

// Displacement of a grating on the board since the reference frame, as a plane about its middle.
struct PrintMotion {
  Extent<frame::Board> displacement;   // mm, at the middle
  Matrix2 gradient = Matrix2::Zero();  // d(displacement) / d(board point), 1
};
// Returns the motion that the points of marker `i` show in `view`.
[[nodiscard]] PrintMotion motion_of_points(const Reference& reference, const View& view, std::size_t i,
                                           const PatchFit& points);

// Returns the reading of a window displaced by `shift`. Its clipped share is that of the reference frame.
[[nodiscard]] PatchReading patch_of_points(const Reference& reference, std::size_t i, const PatchFit& points,
                                           const PrintMotion& motion, Extent<frame::Board> shift);

// Returns the clipped share of the pixels between the outer points.
[[nodiscard]] double clipped_share(const GreyPicture& picture, const PatchFit& points);

// Returns the rms residual beyond the noise of the reference frame and the rounding of a codec, as a share of the
// template's contrast. `rounding` is that of GreyPicture.
[[nodiscard]] double missing_contrast(const PatchFit& points, const PatchFit& at_rest, const PrintModel& model,
                                      double rounding);

// Returns true if less than a tenth of the contrast is missing. More means that something hides a part of the grating.
[[nodiscard]] bool is_whole(const PatchFit& points, const PatchFit& at_rest, const PrintModel& model, double rounding);

// Returns true if the residual proves the fringe order. A window that ends with its grating would contain a strip of
// something else if it were one pitch off. Returns false without an outline.
[[nodiscard]] bool ends_with_print(const PatchFit& points, const PatchFit& at_rest, const PrintModel& model,
                                   double rounding);

}  // namespace moiregauge::internal
