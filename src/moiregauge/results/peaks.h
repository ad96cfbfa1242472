// SPDX-License-Identifier: Apache-2.0
// The peaks of a spectrum: how often it swings, and how fast that would die away.
//
// A peak stands out of the spectrum around it by more than chance allows. What it is decides how it is measured:
//   steady   a sine of one amplitude from end to end: driven, so it says nothing of damping
//   decay    an oscillation that dies away by itself, after a blow or a release: frequency and damping from its shape
//   random   kept going by wind, traffic, anything without a tune: both from the shape of the peak, where the record is
//            long enough to resolve it
// Each frequency and each damping ratio has its standard uncertainty or is not given, with the reason.
#pragma once

#include "moiregauge/results/spectrum.h"
#include "moiregauge/results/summary.h"

namespace moiregauge::internal {

enum class PeakKind { kSteady, kDecay, kRandom };
[[nodiscard]] const char* word_for(PeakKind kind);

struct Peak {
  PeakKind kind = PeakKind::kRandom;
  double frequency_hz = 0.0;    // natural (of a decay: of the undamped oscillator)
  double u_frequency_hz = 0.0;  // k = 1; of the record's own time stamps
  double amplitude_mm = 0.0;    // steady: of the sine; decay: where its fit begins; random: sqrt(2) times the rms
  double damping = kNotMeasured, u_damping = kNotMeasured;  // ratio to critical
  std::string no_damping;                                   // why not; empty where there is one
  double from_s = 0.0, to_s = 0.0;                          // what it was told from
};

// In order of frequency, the strongest kMaxPeaks. Fits look at no more than kMaxFitted samples.
[[nodiscard]] std::vector<Peak> peaks_of(const Series& series, const EvenTimes& times, const Spectrum& spectrum);
inline constexpr std::size_t kMaxPeaks = 5;
inline constexpr std::size_t kMaxFitted = 65536;

// All of it for one axis of one target.
struct AxisSpectrum {
  std::string refusal;  // why there is none; empty where there is one
  double interval_s = 0.0;
  double longest_s = 0.0;  // the longest stretch without a gap
  std::size_t gaps = 0;    // between stretches
  Spectrum spectrum;
  std::vector<Peak> peaks;
};
[[nodiscard]] AxisSpectrum spectrum_of(const Series& series);

struct TargetSpectra {
  AxisSpectrum x, y;
};
[[nodiscard]] std::vector<TargetSpectra> spectra_of(const Samples& samples, const std::vector<TargetSummary>& targets);

}  // namespace moiregauge::internal
