// SPDX-License-Identifier: Apache-2.0
// Shared parts of the solvers: noise of a reading in mm, and its status.
#pragma once

#include <optional>
#include <vector>

#include "moiregauge/displacement/sample.h"
#include "moiregauge/observation/reference/reference.h"
#include "moiregauge/planning/reference_weights.h"

namespace moiregauge::internal {

// Returns the noise of a reading along the board's axes, mm.
[[nodiscard]] BoardExtent noise_mm(const RasterPlan& plan, const PatchReading& patch);

// Returns the noise of every reference as a point of the second homography, mm, in the order of `reference.circles`. It
// is that of the grating, or of the circle if there is none.
[[nodiscard]] std::vector<BoardExtent> reference_noise(const Reference& reference, const Observation& seen);

// Returns the status of a target that was not read.
[[nodiscard]] Status status_of_loss(Loss loss);

// Returns kSaturated, kBlurred or kOk. `clipped_before`: clipped share of the pixels that the template already
// contains.
[[nodiscard]] Status sharpness(const PatchReading& then, const PatchReading& now, double clipped_before = 0.0);
// Returns kPartlyCovered for a bent phase field, otherwise the result of `sharpness`.
[[nodiscard]] Status quality(const RasterPlan& plan, const PatchReading& then, const PatchReading& now);

// Returns the status of the image of a grating that was read, compared with its template: kOk, kSaturated, kBlurred or
// kPartlyCovered.
[[nodiscard]] Status image_status(const Reference& reference, const MarkerObservation& seen, std::size_t marker);

// Returns the displacement with an assumed movement along the lines of a grating of lines, mm. The grating does not show
// it. It is the root of the sum of squares of a tenth of the pitch and of the movement across the lines. Displacements of
// other gratings are unchanged.
[[nodiscard]] Extent<frame::Board> with_movement_along_lines(const Grating& grating, Extent<frame::Board> displacement);
// Adds the part of this movement that appears across the lines to budget.axis, because the lines are not parallel to a
// board axis. The axis along them becomes NaN; both do if the lines are oblique to both. `u_rotation_rad`: u of the
// grating's angle. Other gratings are unchanged.
void add_movement_along_lines(const Grating& grating, double u_rotation_rad, Sample& sample);
// Removes u along axes whose displacement is NaN.
void withhold_unshown_axes(Sample& sample);

// Returns true for reference gratings whose lattice line is uncertain, one per site marker. They are more than 0.4
// pitch from the position that the circles imply.
[[nodiscard]] std::vector<bool> references_in_doubt(const Reference& reference, const Observation& seen);
// Returns true if this holds for any reference.
[[nodiscard]] bool order_in_doubt(const Reference& reference, const Observation& seen);

[[nodiscard]] bool is_target(const Reference& reference, std::size_t marker);

// Returns the start of a row. It is final (zero by definition) in the reference frame, otherwise NaN.
[[nodiscard]] Sample initial_sample(const Reference& reference, const Observation& seen, std::size_t marker);

}  // namespace moiregauge::internal
