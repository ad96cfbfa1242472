// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/peaks.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "moiregauge/results/peak_fit.h"
#include "moiregauge/results/random_fit.h"

namespace moiregauge::internal {
namespace {

// Chance alone makes one of 10^7 ordinates stand out so far (5.2 standard deviations of a normal distribution).
constexpr double kOneOfMany = 5.2;
constexpr double kQuartile = -0.6745;     // as a normal deviate
constexpr double kMinRatio = 3.0;         // and a hill that is no higher than this is no peak
constexpr double kMinCycles = 3.0;        // in the record; slower is drift
constexpr std::size_t kLevelAround = 25;  // ordinates to each side that tell the level about one
constexpr double kResolvedWidth = 4.0;  // half-power width in units of 1 / duration, below which it is the window's own
constexpr double kCrumb = 0.05;         // of the strongest peak's amplitude
constexpr double kUsefulDamping = 1.0 / 3.0;  // u / value

// chi^2 with 2 K degrees of freedom, per degree: the value that a normal deviate z reaches (Wilson and Hilferty, 1931).
double chi_square(double averages, double z) {
  const double part = 1.0 / (9.0 * averages);
  return std::pow(1.0 - part + z * std::sqrt(part), 3);
}

// The level about an ordinate: the lower quartile of those around it, brought to the mean's. A broad peak lifts the
// median of its surroundings before it lifts that.
double level_about(const std::vector<double>& psd, std::size_t k, double averages) {
  const std::size_t from = std::max<std::size_t>(1, k > kLevelAround ? k - kLevelAround : 1);
  const std::size_t to = std::min(psd.size() - 1, k + kLevelAround + 1);
  std::vector<double> around(psd.begin() + static_cast<std::ptrdiff_t>(from),
                             psd.begin() + static_cast<std::ptrdiff_t>(to));
  const auto quartile = around.begin() + static_cast<std::ptrdiff_t>(around.size() / 4);
  std::nth_element(around.begin(), quartile, around.end());
  return *quartile / chi_square(averages, kQuartile);
}

struct Taken {
  double from_hz, to_hz;
  [[nodiscard]] bool holds(double f) const { return f >= from_hz && f <= to_hz; }
};

// The highest ordinate above its surroundings that no peak has taken yet.
std::optional<double> next_peak(const Spectrum& s, const std::vector<Taken>& taken, double lowest_hz) {
  const double threshold = std::max(kMinRatio, chi_square(s.averages, kOneOfMany));
  std::optional<double> best;
  double highest = 0.0;
  for (std::size_t k = 1; k + 2 < s.psd.size(); ++k) {
    const double f = s.frequency_hz[k];
    if (f < lowest_hz || s.psd[k] <= highest || s.psd[k] < s.psd[k - 1] || s.psd[k] < s.psd[k + 1]) continue;
    if (std::any_of(taken.begin(), taken.end(), [f](const Taken& t) { return t.holds(f); })) continue;
    if (s.psd[k] < threshold * level_about(s.psd, k, s.averages)) continue;
    highest = s.psd[k];
    best = f;
  }
  return best;
}

// A random peak whose shape the record resolves, or its place alone.
Peak random_peak(const Series& series, const EvenTimes& times, double near_hz, const Taken& own) {
  const Stretch& all = times.longest();
  const Spectrum fine = periodogram(&series.value[all.first], all.count, times.interval_s);
  const double duration = static_cast<double>(all.count) * times.interval_s;
  Peak peak;
  peak.from_s = series.time_s[all.first];
  peak.to_s = series.time_s[all.first + all.count - 1];
  const auto fit = fit_random(fine, near_hz, own.from_hz, own.to_hz);
  const bool is_resolved = fit && fit->width_hz() * duration > kResolvedWidth;
  if (is_resolved) {
    peak.frequency_hz = fit->frequency_hz;
    peak.u_frequency_hz = fit->u_frequency_hz;
    peak.amplitude_mm = std::sqrt(2.0) * fit->rms();
    if (fit->u_damping < kUsefulDamping * fit->damping) {
      peak.damping = fit->damping;
      peak.u_damping = fit->u_damping;
      return peak;
    }
    peak.no_damping = fmt::format("{:.0f} s tell it no better than to {:.0f} %: a longer record does", duration,
                                  100.0 * fit->u_damping / fit->damping);
    return peak;
  }
  // The place of the power about its middle; it is not known better than the window resolves.
  double power = 0.0, moment = 0.0;
  for (std::size_t k = 1; k < fine.psd.size(); ++k) {
    if (std::abs(fine.frequency_hz[k] - near_hz) > 2.0 * fine.resolution_hz) continue;
    power += fine.psd[k];
    moment += fine.psd[k] * fine.frequency_hz[k];
  }
  peak.frequency_hz = power > 0.0 ? moment / power : near_hz;
  peak.u_frequency_hz = fine.resolution_hz;
  peak.amplitude_mm = std::sqrt(2.0 * power * fine.frequency_hz[1]);
  peak.no_damping = fmt::format(
      "the peak is no wider than {:.0f} s resolve ({:.2g} Hz): a longer record, or a free decay, "
      "tells it",
      duration, fine.resolution_hz);
  return peak;
}

Taken about(const Peak& peak, const Spectrum& s) {
  const double half =
      std::max(2.0 * s.resolution_hz, std::isnan(peak.damping) ? 0.0 : 5.0 * peak.damping * peak.frequency_hz);
  return {peak.frequency_hz - half, peak.frequency_hz + half};
}

// What lies between a peak and its neighbours, or ten widths of it.
Taken own_band(double f, double lowest_hz, const std::vector<Taken>& taken, const Spectrum& s) {
  Taken own{std::max(lowest_hz, f - std::max(10.0 * s.resolution_hz, 0.5 * f)),
            std::min(s.frequency_hz.back(), f + std::max(10.0 * s.resolution_hz, 0.5 * f))};
  for (const Taken& t : taken) {
    if (t.to_hz < f) own.from_hz = std::max(own.from_hz, t.to_hz);
    if (t.from_hz > f) own.to_hz = std::min(own.to_hz, t.from_hz);
  }
  return own;
}

// A frequency known no better than this is none: so much is left of a slow step or of a ramp.
constexpr double kKnownWithin = 0.1;  // relative standard uncertainty

// What a step or a ramp leaves: beside a strong vibration it has no shape of its own, and little of its amplitude.
void leave_out_crumbs(std::vector<Peak>& found) {
  double most = 0.0;
  for (const Peak& peak : found) most = std::max(most, peak.amplitude_mm);
  std::erase_if(found, [&](const Peak& p) {
    if (p.kind != PeakKind::kRandom) return false;
    return !(p.u_frequency_hz < kKnownWithin * p.frequency_hz) ||
           (std::isnan(p.damping) && p.amplitude_mm < kCrumb * most);
  });
}

}  // namespace

const char* word_for(PeakKind kind) {
  return kind == PeakKind::kSteady ? "steady" : kind == PeakKind::kDecay ? "decay" : "random";
}

std::vector<Peak> peaks_of(const Series& series, const EvenTimes& times, const Spectrum& spectrum) {
  const Stretch& longest = times.longest();
  const double duration = static_cast<double>(longest.count) * times.interval_s;
  const double lowest = std::max(kMinCycles / duration, 1.5 * spectrum.resolution_hz);
  PeakFits fits(series, times);
  std::vector<Taken> taken;
  std::vector<Peak> found;
  Spectrum left = spectrum;
  while (found.size() < kMaxPeaks) {
    const auto near = next_peak(left, taken, lowest);
    if (!near) break;
    if (fits.take(*near, left.resolution_hz)) {
      found.push_back(fits.last());
      left = *welch(fits.left(), times);  // the same stretches
    } else {
      found.push_back(random_peak(fits.left(), times, *near, own_band(*near, lowest, taken, left)));
    }
    taken.push_back(about(found.back(), spectrum));
    taken.push_back({*near - spectrum.resolution_hz, *near + spectrum.resolution_hz});  // never twice the same
  }
  fits.refine(found);
  leave_out_crumbs(found);
  std::sort(found.begin(), found.end(), [](const Peak& a, const Peak& b) { return a.frequency_hz < b.frequency_hz; });
  return found;
}

AxisSpectrum spectrum_of(const Series& series) {
  AxisSpectrum result;
  const auto times = even_times(series);
  if (!times) {
    result.refusal = times.error();
    return result;
  }
  auto spectrum = welch(series, *times);
  if (!spectrum) {
    result.refusal = spectrum.error();
    return result;
  }
  result.interval_s = times->interval_s;
  result.longest_s = static_cast<double>(times->longest().count) * times->interval_s;
  result.gaps = times->stretches.size() - 1;
  result.peaks = peaks_of(series, *times, *spectrum);
  result.spectrum = *std::move(spectrum);
  return result;
}

std::vector<TargetSpectra> spectra_of(const Samples& samples, const std::vector<TargetSummary>& targets) {
  std::vector<TargetSpectra> spectra;
  for (const TargetSummary& target : targets) {
    spectra.push_back({spectrum_of(series_of(samples, target.marker, &Extent<frame::Board>::x)),
                       spectrum_of(series_of(samples, target.marker, &Extent<frame::Board>::y))});
  }
  return spectra;
}

}  // namespace moiregauge::internal
