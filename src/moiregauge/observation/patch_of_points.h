// SPDX-License-Identifier: Apache-2.0
// What a raster would have read, told from the points of a print's fit: phases against the reference frame's, so that
// all that asks for a patch gets the same answer whichever way it was looked at.
#pragma once

#include "moiregauge/observation/reference.h"

namespace moiregauge {

// How far the middle of the print has gone on the board since the reference frame, mm.
[[nodiscard]] Extent<frame::Board> moved_by_points(const Reference& reference, const View& view, std::size_t i,
                                                   const PatchFit& points);

// As read in a window shifted by `shift`.
[[nodiscard]] PatchReading patch_of_points(const GreyPicture& picture, const Reference& reference, const View& view,
                                           std::size_t i, const PatchFit& points, Extent<frame::Board> shift);

// A print of which pixels miss its template by more than a tenth of its contrast, rms, beyond their noise, is not whole.
[[nodiscard]] bool is_whole(const PatchFit& points, const MarkerObservation& at_rest, const PrintModel& model);

}  // namespace moiregauge
