// SPDX-License-Identifier: Apache-2.0
// One-sided power spectral density by Welch's method (P. D. Welch, IEEE Trans. Audio Electroacoust. 15, 1967, 70-73):
// segments that overlap by half, mean and slope of each taken out, Hann's window. The integral over all frequencies is
// the variance.
#pragma once

#include <vector>

#include "moiregauge/results/series.h"

namespace moiregauge::internal {

struct Spectrum {
  std::vector<double> frequency_hz;
  std::vector<double> psd;     // mm^2/Hz
  double resolution_hz = 0.0;  // equivalent noise bandwidth, 1.5 / (segment_samples interval_s)
  double averages = 0.0;       // independent ones that these segments are worth
  std::size_t segment_samples = 0;
  std::size_t segments = 0;  // all of them free of gaps
  std::size_t samples = 0;   // that lie in segments
};

inline constexpr std::size_t kMinSamples = 32;  // in one stretch; less shows no more than a handful of frequencies
inline constexpr std::size_t kMaxSegment = 16384;

// The segments' length follows from the longest stretch: a third of it, so that five segments or more are averaged, and
// never above kMaxSegment. Shorter stretches than a segment are left out.
// fails   when the longest stretch is shorter than kMinSamples
[[nodiscard]] tl::expected<Spectrum, std::string> welch(const Series& series, const EvenTimes& times);

// The same of one segment as long as the samples, which are even: for what needs all the resolution there is.
[[nodiscard]] Spectrum periodogram(const double* value, std::size_t count, double interval_s);

}  // namespace moiregauge::internal
