// SPDX-License-Identifier: Apache-2.0
// Planned grating: its template as a camera of known sharpness would show it.
#pragma once

#include "moiregauge/phase/fit/print_template.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal {

struct PlannedOptics {
  double contrast = 170.0;    // grey levels from ink to paper
  double psf_sigma_px = 0.7;  // a focused lens; the pixel's square is added
  double blur_x_px = 0.0;     // movement of the grating during the exposure
  double blur_y_px = 0.0;
};

// Returns the template: the Fourier series of the pattern times the transfer functions of lens, pixel and motion blur.
//
//     exp(-2 pi^2 sigma^2 q^2 / P^2) sinc(m / P) sinc(n / P) sinc(m b_x / P) sinc(n b_y / P)
//
// P is the pitch in px and q^2 = m^2 + n^2. Half of a pitch is dark; kCosine is one wave along each axis. The orders
// are those that the pixels carry (highest_order). kAuto counts as crossed lines. `pitch_px`: at least 2.5.
[[nodiscard]] PrintTemplate planned_print(Pattern pattern, double pitch_px, const PlannedOptics& optics);

}  // namespace moiregauge::internal
