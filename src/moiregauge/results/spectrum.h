// SPDX-License-Identifier: Apache-2.0
// One-sided power spectral density by Welch's method (P. D. Welch, IEEE Trans. Audio Electroacoust. 15, 1967, 70-73).
// Segments overlap by half; mean and slope of each are removed; the window is Hann's. The integral over all frequencies
// is the variance.
#pragma once

#include <vector>

#include "moiregauge/results/series.h"

namespace moiregauge::internal {

struct Spectrum {
  std::vector<double> frequency_hz;
  std::vector<double> psd;     // mm^2/Hz
  double resolution_hz = 0.0;  // equivalent noise bandwidth, 1.5 / (segment_samples interval_s)
  double averages = 0.0;       // equivalent number of independent segments
  std::size_t segment_samples = 0;
  std::size_t segments = 0;  // segments without gaps
  std::size_t samples = 0;   // samples in segments
};

inline constexpr std::size_t kMinSamples = 32;  // least length of a stretch; fewer show only a handful of frequencies
inline constexpr std::size_t kMaxSegment = 16384;  // largest length of a segment; chosen

// Returns the spectrum of a series. A segment is a third of the longest stretch, so at least five are averaged, and at
// most kMaxSegment. Stretches shorter than a segment do not count.
// Fails (reason): the longest stretch is shorter than kMinSamples.
[[nodiscard]] tl::expected<Spectrum, std::string> welch(const Series& series, const EvenTimes& times);

// Returns the spectrum of one segment over all samples, which must be even, with the best resolution. The length is
// reduced to factors 2, 3 and 5.
[[nodiscard]] Spectrum periodogram(const double* value, std::size_t count, double interval_s);

}  // namespace moiregauge::internal
