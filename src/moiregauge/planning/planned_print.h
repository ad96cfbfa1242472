// SPDX-License-Identifier: Apache-2.0
// A print that has not been seen yet: its template as a camera of known sharpness would show it.
#pragma once

#include "moiregauge/phase/fit/print_template.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal {

struct PlannedOptics {
  double contrast = 170.0;    // grey levels from ink to paper
  double psf_sigma_px = 0.7;  // a lens in focus; the pixel's own square comes on top
  double blur_x_px = 0.0;     // way of the print during the exposure
  double blur_y_px = 0.0;
};

// The pattern's Fourier series (half of a pitch is dark; cosine: one wave each way) times what lens, pixel and motion
// leave of every harmonic: exp(-2 pi^2 sigma^2 q^2 / P^2) sinc(m / P) sinc(n / P) sinc(m b_x / P) sinc(n b_y / P), P
// the pitch in px, q^2 = m^2 + n^2. As many harmonics as the pixels carry (highest_order). kAuto is taken for crossed
// lines. At least 2.5 px of pitch.
[[nodiscard]] PrintTemplate planned_print(Pattern pattern, double pitch_px, const PlannedOptics& optics);

}  // namespace moiregauge::internal
