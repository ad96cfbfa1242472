// SPDX-License-Identifier: Apache-2.0
// Something that lies over a part of a print: found by where the print's pixels miss its template, and left out.
#pragma once

#include <optional>

#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

// Looked for only where the misses as a whole changed since the reference frame.
//
// at_rest, fit   the print's points then and now
// A lossy codec leaves some blocks coarser than others: picture.rounding is allowed for.
[[nodiscard]] CoveredBlocks find_occluded_blocks(const GreyPicture& picture, const PrintModel& model,
                                                 const PatchFit& at_rest, const PatchFit& fit);

// The points of the part that is free; nothing when that is too little, or has something over it still.
[[nodiscard]] std::optional<PatchFit> free_points(const GreyPicture& picture, const PrintModel& model,
                                                  const PatchFit& at_rest, const PatchFit& fit,
                                                  const BlockSet& covered);

}  // namespace moiregauge::internal
