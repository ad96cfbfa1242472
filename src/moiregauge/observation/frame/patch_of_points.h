// SPDX-License-Identifier: Apache-2.0
// What a raster would have read, told from the points of a print's fit: phases against the reference frame's, so that
// all that asks for a patch gets the same answer whichever way it was looked at.
#pragma once

#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

// How a print has gone on the board since the reference frame: a plane about its middle.
struct PrintMotion {
  Extent<frame::Board> displacement;   // mm, of the middle
  Matrix2 gradient = Matrix2::Zero();  // d(displacement) / d(board point)
};
[[nodiscard]] PrintMotion motion_of_points(const Reference& reference, const View& view, std::size_t i,
                                           const PatchFit& points);

// As read in a window shifted by `shift`; its clipped share is that of the reference frame.
[[nodiscard]] PatchReading patch_of_points(const Reference& reference, std::size_t i, const PatchFit& points,
                                           const PrintMotion& motion, Extent<frame::Board> shift);

// Of the pixels between the outer points.
[[nodiscard]] double clipped_share(const GreyPicture& picture, const PatchFit& points);

// By how much pixels miss the print's template beyond their noise in the reference frame, and what a codec may round
// away (GreyPicture), rms, of its contrast.
[[nodiscard]] double missing_contrast(const PatchFit& points, const PatchFit& at_rest, const PrintModel& model,
                                      double rounding);

// More than a tenth, and something hides a part of it.
[[nodiscard]] bool is_whole(const PatchFit& points, const PatchFit& at_rest, const PrintModel& model, double rounding);

// One pitch beside its print, a window that ends with the print holds a strip of something else (its outline was seen to
// stand out): does so little miss the template that it cannot be?
[[nodiscard]] bool ends_with_print(const PatchFit& points, const PatchFit& at_rest, const PrintModel& model,
                                   double rounding);

}  // namespace moiregauge::internal
