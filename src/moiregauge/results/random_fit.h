// SPDX-License-Identifier: Apache-2.0
// Frequency and damping of a random vibration, as wind and traffic cause in a bridge.
//
// The power spectral density of its displacement, above a level B of noise and other modes, is that of an oscillator
// driven by white noise.
//
//     S(f) = S0 4 zeta^2 / ((1 - f^2/f0^2)^2 + 4 zeta^2 f^2/f0^2) + B
//
// The fit maximises Whittle's likelihood of one Hann periodogram: each ordinate has an exponential distribution about
// S(f), smeared by the window. The Fisher information is divided by 1.94, because neighbouring ordinates of a Hann
// window have correlations of 4/9 and 1/36. The best possible result is Au's law (S.-K. Au, Mech. Syst. Signal Process.
// 48, 2014, 15-33).
#pragma once

#include <optional>

#include "moiregauge/results/spectrum.h"

namespace moiregauge::internal {

struct RandomFit {
  double frequency_hz = 0.0, u_frequency_hz = 0.0;
  double damping = 0.0, u_damping = 0.0;                                          // zeta, ratio to critical damping
  double peak = 0.0;                                                              // S0, mm^2/Hz
  [[nodiscard]] double rms() const;                                               // mm, of the oscillation
  [[nodiscard]] double width_hz() const { return 2.0 * damping * frequency_hz; }  // full width at half power
};

// Fits the peak near `around_hz`.
// `of_all`: one Hann periodogram of the whole stretch.
// `lowest_hz`, `highest_hz`: the band of this peak, up to the neighbouring peaks.
// Fails (nothing): the likelihood has no maximum in that band.
[[nodiscard]] std::optional<RandomFit> fit_random(const Spectrum& of_all, double around_hz, double lowest_hz,
                                                  double highest_hz);

}  // namespace moiregauge::internal
