// SPDX-License-Identifier: Apache-2.0
// Lens of a set's camera, solved from the set's own views, and the views without its distortion.
#pragma once

#include <vector>

#include "moiregauge/board/board_calibration.h"
#include "real/real_lattices.h"

namespace moiregauge::internal::test {

// Solves the camera from all views of a set.
[[nodiscard]] BoardCalibration calibrated(const std::vector<LatticeView>& views);
// Returns the points without the distortion of `camera`.
[[nodiscard]] Places without_lens(const Places& places, const Camera& camera);
// Returns the median, in px, of the nulls between the first view and each other view.
[[nodiscard]] double median_null(const std::vector<LatticeView>& views, const Camera& camera);
// Returns the largest of these nulls in px.
[[nodiscard]] double worst_null(const std::vector<LatticeView>& views, const Camera& camera);

}  // namespace moiregauge::internal::test
