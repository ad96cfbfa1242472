// SPDX-License-Identifier: Apache-2.0
// Fits a grating whose blur differs from that of the reference frame, as in a camera that moves during the exposure
// (docs/methods/precise/fit.md).
//
// The columns of blur in patch_fit.h are linear in the change of the PSF's variance. They fail once the change resembles
// the variance itself. Here the template is learned again from the frame. Its harmonics d(m, n) have the amplitudes of
// this frame's blur. A symmetric PSF changes no phase, except by pi. The template of the reference frame is c(m, n).
// The phases give the shift (x, y) from it:
//
//     arg(d / c) = 2 pi (m x + n y)  modulo pi,     u^2 = sigma_c^2 / (2 N |c|^2) + sigma_d^2 / (2 N |d|^2)
//
// The new template with this shift is then fitted to the pixels as usual. Phases that disagree beyond their u show a
// PSF that is not symmetric, and enlarge u.
#pragma once

#include <optional>

#include "moiregauge/observation/print/print_model.h"

namespace moiregauge::internal {

// Pixel noise and number of pixels of the fits that two templates come from.
struct TemplateNoise {
  double sigma = 0.0;   // grey levels at the template's contrast
  double pixels = 0.0;  // 1
};

// Shift between two templates of the same grating.
struct TemplateShift {
  PrintPoint at;                                          // pitches
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();  // 1/pitch^2
  double chi2_dof = 1.0;                                  // how well the phases agree
};

// Returns the shift of `now` relative to `then` by the phases of their harmonics. It must be below a tenth of a pitch.
// Fails (nothing): too few harmonics exceed the noise.
// Error: the inverse of `information`, times `chi2_dof` if that exceeds 1.
[[nodiscard]] std::optional<TemplateShift> shift_by_phases(const PrintSeries& then, const TemplateNoise& noise_then,
                                                           const PrintSeries& now, const TemplateNoise& noise_now,
                                                           const PatchFitOptions& options);

// Returns the fit by a template with this frame's blur. Light, contrast and fundamentals remain relative to the
// reference frame's template.
// `rounding`: error that a lossy codec may leave in a pixel, grey levels, rms; 0 for other footage.
// Fails (nothing): the residual of `fit` is that of the reference frame (`at_rest`) or of the codec, or this blur does
// not explain it.
[[nodiscard]] std::optional<PatchFit> fit_in_own_blur(const LumaView& luma, const PrintModel& model,
                                                      const PatchFit& at_rest, const PatchFit& fit, double rounding);

}  // namespace moiregauge::internal
