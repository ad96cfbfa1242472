// SPDX-License-Identifier: Apache-2.0
// Peaks of a spectrum: frequency and damping.
//
// A peak exceeds the spectrum around it by more than chance allows. Its kind decides how it is measured.
// - steady: a sine of constant amplitude. It is driven, so it shows no damping.
// - decay: a free vibration after an impact or a release. Its shape gives frequency and damping.
// - random: a vibration sustained by wind, traffic or other noise. The shape of the peak gives both, if the record is
//   long enough to resolve it.
//
// Each frequency and damping ratio has its standard uncertainty. Otherwise it is not given, and the reason is stated.
#pragma once

#include "moiregauge/results/spectrum.h"
#include "moiregauge/results/summary.h"

namespace moiregauge::internal {

enum class PeakKind { kSteady, kDecay, kRandom };
[[nodiscard]] const char* word_for(PeakKind kind);

struct Peak {
  PeakKind kind = PeakKind::kRandom;
  double frequency_hz = 0.0;    // natural; for a decay that of the undamped oscillator
  double u_frequency_hz = 0.0;  // k = 1, by the record's own time stamps
  double amplitude_mm = 0.0;    // steady: of the sine; decay: at the start of its fit; random: sqrt(2) times the rms
  double damping = kNotMeasured, u_damping = kNotMeasured;  // ratio to critical damping
  std::string no_damping;                                   // reason if there is no damping, otherwise empty
  double from_s = 0.0, to_s = 0.0;                          // time span of the fit
};

// Returns the strongest kMaxPeaks peaks, in order of frequency. Fits use at most kMaxFitted samples.
[[nodiscard]] std::vector<Peak> peaks_of(const Series& series, const EvenTimes& times, const Spectrum& spectrum);
inline constexpr std::size_t kMaxPeaks = 5;       // chosen
inline constexpr std::size_t kMaxFitted = 65536;  // limits the time of the fits; chosen

// Spectrum and peaks of one axis of one target.
struct AxisSpectrum {
  std::string refusal;  // reason if there is no spectrum, otherwise empty
  double interval_s = 0.0;
  double longest_s = 0.0;  // longest stretch without a gap
  std::size_t gaps = 0;    // number of gaps between stretches
  Spectrum spectrum;
  std::vector<Peak> peaks;
};
// Returns the spectrum and the peaks of a series.
[[nodiscard]] AxisSpectrum spectrum_of(const Series& series);

struct TargetSpectra {
  AxisSpectrum x, y;
};
[[nodiscard]] std::vector<TargetSpectra> spectra_of(const Samples& samples, const std::vector<TargetSummary>& targets);

}  // namespace moiregauge::internal
