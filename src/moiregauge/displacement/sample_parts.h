// SPDX-License-Identifier: Apache-2.0
// What the methods' solvers share: the noise of a patch as millimetres, and the status of a reading.
#pragma once

#include <optional>
#include <vector>

#include "moiregauge/displacement/sample.h"
#include "moiregauge/observation/reference/reference.h"
#include "moiregauge/planning/reference_weights.h"

namespace moiregauge::internal {

// Noise of a patch along the board's axes, mm.
[[nodiscard]] BoardExtent noise_mm(const RasterPlan& plan, const PatchReading& patch);

// Noise of every reference circle (in the order of `reference.circles`) as a point of the second homography, mm: its
// grating's, or without one the circle's own.
[[nodiscard]] std::vector<BoardExtent> reference_noise(const Reference& reference, const Observation& seen);

[[nodiscard]] Status status_of_loss(Loss loss);

// Is the print sharp and within the sensor's range? kOk, or what is wrong with it. `clipped_before`: share of its pixels that were
// clipped in the frame it is compared with, and are in its template so.
[[nodiscard]] Status sharpness(const PatchReading& then, const PatchReading& now, double clipped_before = 0.0);
// Is the print whole, sharp and within the sensor's range? kOk, or what is wrong with it.
[[nodiscard]] Status quality(const RasterPlan& plan, const PatchReading& then, const PatchReading& now);

// Reference gratings so far from where the circles put them that their lattice line is in doubt; one per site marker.
[[nodiscard]] std::vector<bool> references_in_doubt(const Reference& reference, const Observation& seen);
// Any of them?
[[nodiscard]] bool order_in_doubt(const Reference& reference, const Observation& seen);

[[nodiscard]] bool is_target(const Reference& reference, std::size_t marker);

// The row to begin with: zero in the reference frame (by definition, and finished), else nothing measured.
[[nodiscard]] Sample initial_sample(const Reference& reference, const Observation& seen, std::size_t marker);

}  // namespace moiregauge::internal
