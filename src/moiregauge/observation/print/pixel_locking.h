// SPDX-License-Identifier: Apache-2.0
// Pixel locking: an error of a displacement that repeats with every pixel of movement
// (docs/methods/precise/uncertainty.md).
//
// Harmonics beyond half a cycle per pixel fold onto lower ones. The template contains the folded ones as they were in
// the reference frame. Along one image axis they turn by a whole period per pixel, and the fit follows them in part. The
// error of a lattice line at x px is A sin(2 pi x + constant) minus its value in the reference frame. Lines at all
// fractions of a pixel cancel.
#pragma once

#include <array>
#include <complex>

#include "moiregauge/observation/print/print_model.h"

namespace moiregauge::internal {

// Values along X and Y of a grating.
using LockingAmplitude = std::array<double, 2>;          // pitches
using PixelPhase = std::array<std::complex<double>, 2>;  // absolute value at most 1

// Returns the amplitude A that the template predicts for lines of the worst width. The harmonics beyond the template
// continue the envelope of those it has, with the fall of a Gaussian PSF. 0: below 0.002 px, or below six orders.
// Error: a factor of 0.5 to 3 for binary gratings behind a PSF of 0.3 to 0.5 px. Median filters have a third of it.
[[nodiscard]] LockingAmplitude expected_locking(const PrintModel& print, const PatchFit& at_rest);

// Returns the mean of exp(2 pi i x) over the lattice lines in the window, with x the image coordinate (px) across the
// lines. Its absolute value is 1 if all lines have the same position relative to the pixels. It is 0 for a grating that
// is turned by a pixel over its length.
[[nodiscard]] PixelPhase pixel_phase(const PatchFit& fit, const PatchWindow& window);

}  // namespace moiregauge::internal
