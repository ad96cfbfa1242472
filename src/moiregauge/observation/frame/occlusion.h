// SPDX-License-Identifier: Apache-2.0
// Finds occlusions by the residuals of a template fit, and excludes them.
#pragma once

#include <optional>

#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

// Returns the blocks of a window that are covered in one frame only. `at_rest` is the fit of the reference frame, `fit`
// that of this one. Blocks are examined only if sigma changed since the reference frame. `picture.rounding` allows for
// blocks that a lossy codec leaves coarser than others. `rows`: those of the fit.
[[nodiscard]] CoveredBlocks find_occluded_blocks(const GreyPicture& picture, const PrintModel& model,
                                                 const PatchFit& at_rest, const PatchFit& fit, Rows rows = Rows::kAll);

// Fits the free part of the window.
// Fails (nothing): the free part is too small, or still partly covered.
[[nodiscard]] std::optional<PatchFit> free_points(const GreyPicture& picture, const PrintModel& model,
                                                  const PatchFit& at_rest, const PatchFit& fit,
                                                  const BlockSet& covered);

}  // namespace moiregauge::internal
