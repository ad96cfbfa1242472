// SPDX-License-Identifier: Apache-2.0
// The lens of a set's camera from the set's own views, and the views with that lens taken out.
#pragma once

#include <vector>

#include "moiregauge/board/board_calibration.h"
#include "real/real_lattices.h"

namespace moiregauge::internal::test {

[[nodiscard]] BoardCalibration calibrated(const std::vector<LatticeView>& views);
[[nodiscard]] Places without_lens(const Places& places, const Camera& camera);
// Median over the views after the first of the null between each and the first.
[[nodiscard]] double median_null(const std::vector<LatticeView>& views, const Camera& camera);
[[nodiscard]] double worst_null(const std::vector<LatticeView>& views, const Camera& camera);

}  // namespace moiregauge::internal::test
