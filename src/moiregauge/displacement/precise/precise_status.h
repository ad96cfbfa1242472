// SPDX-License-Identifier: Apache-2.0
// Status of a row of `precise`.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "moiregauge/calibration/scene/frame_fit.h"
#include "moiregauge/calibration/scene/out_of_plane.h"
#include "moiregauge/displacement/method.h"

namespace moiregauge::internal {

// chi2 per degree of freedom above which a frame does not belong to the scene and is `untrusted`. Something moved, or
// the shutter rolls. Chosen.
inline constexpr double kUntrustedChi2 = 25.0;

// Returns the status of target `i` in one frame, fitted to the scene. Above `untrusted_chi2` per degree of freedom the
// row is kUntrusted.
[[nodiscard]] Status precise_status(const Reference& reference, const Observation& seen, std::size_t i,
                                    const FrameFit& fit, double untrusted_chi2);

// A run has one height for each target. So a movement towards the camera appears as a displacement wherever the line of
// sight is oblique.

// Returns true if the heights may change the displacement by more than its u.
[[nodiscard]] bool may_matter(const OutOfPlane& moved, const Sample& sample);
// Returns true if it does so, and is significant in a single row.
[[nodiscard]] bool is_out_of_plane(const OutOfPlane& moved, const Sample& sample);

// A row for which may_matter() is true.
struct RowOutOfPlane {
  std::size_t sample = 0;  // index in the samples
  OutOfPlane moved;
};

// Marks all rows of targets that move out of their plane as untrusted. One row must be significant among all samples,
// or the heights scatter or drift (HeightSeries). The scene's one height is then wrong in all frames, and the pose
// hides an unknown part. Returns one warning per such target.
// `heights`: of all rows, one per site marker.
[[nodiscard]] std::vector<std::string> distrust_out_of_plane(const Site& site, std::span<const RowOutOfPlane> rows,
                                                             std::span<const HeightSeries> heights, Samples& samples,
                                                             bool knows_focal_length);

}  // namespace moiregauge::internal
