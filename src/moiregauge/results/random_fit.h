// SPDX-License-Identifier: Apache-2.0
// Frequency and damping of an oscillator that is driven at random, as wind and traffic drive a bridge.
//
// The power spectral density of its displacement is, above a level B of noise and of other modes,
//   S(f) = S0 4 zeta^2 / ((1 - f^2/f0^2)^2 + 4 zeta^2 f^2/f0^2) + B.
// Whittle's likelihood of one Hann periodogram: each ordinate is exponentially distributed about S(f) as Hann's window
// smears it. Fisher's information is divided by 1.94, for neighbouring ordinates of Hann's window are correlated by 4/9
// and 1/36. What it reaches in the best case is Au's law (S.-K. Au, Mech. Syst. Signal Process. 48, 2014, 15-33).
#pragma once

#include <optional>

#include "moiregauge/results/spectrum.h"

namespace moiregauge::internal {

struct RandomFit {
  double frequency_hz = 0.0, u_frequency_hz = 0.0;
  double damping = 0.0, u_damping = 0.0;                                          // zeta, ratio to critical
  double peak = 0.0;                                                              // S0, mm^2/Hz
  [[nodiscard]] double rms() const;                                               // mm, of the oscillation
  [[nodiscard]] double width_hz() const { return 2.0 * damping * frequency_hz; }  // at half power
};

// of_all    one Hann periodogram of the whole stretch
// around_hz where the peak is, roughly
// lowest_hz, highest_hz   the band that is its own: up to the neighbouring peaks
// Nothing when the likelihood has no maximum there.
[[nodiscard]] std::optional<RandomFit> fit_random(const Spectrum& of_all, double around_hz, double lowest_hz,
                                                  double highest_hz);

}  // namespace moiregauge::internal
