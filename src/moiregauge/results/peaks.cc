// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/peaks.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "moiregauge/results/peak_fit.h"
#include "moiregauge/results/random_fit.h"
#include "moiregauge/results/short_record.h"

namespace moiregauge::internal {
namespace {

// Threshold of a peak as a normal deviate: noise alone exceeds it once in 10^7 ordinates.
constexpr double kOneOfMany = 5.2;
constexpr double kQuartile = -0.6745;     // lower quartile as a normal deviate
constexpr double kMinRatio = 3.0;         // least height of a peak over its level; chosen
constexpr std::size_t kLevelAround = 25;  // ordinates to each side that give the level; chosen
// Least half-power width of a resolved peak, in units of 1 / duration. A narrower one has the width of the window.
constexpr double kResolvedWidth = 4.0;
constexpr double kCrumb = 0.05;  // least amplitude of an unresolved random peak, share of the strongest; chosen
constexpr double kUsefulDamping = 1.0 / 3.0;  // largest u / value of a stated damping; chosen

// Returns the quantile of chi-squared with 2 K degrees of freedom, per degree, at the normal deviate z (Wilson and
// Hilferty 1931). K is `averages`.
double chi_square(double averages, double z) {
  const double part = 1.0 / (9.0 * averages);
  return std::pow(1.0 - part + z * std::sqrt(part), 3);
}

// Returns the level around an ordinate: the lower quartile of the ordinates around it, converted to a mean. A broad
// peak affects the quartile less than the median.
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

// Returns the frequency of the highest ordinate above its surroundings that is not yet part of a peak.
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

// Returns a random peak with damping if the record resolves its shape, otherwise with its frequency only.
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
    peak.no_damping = fmt::format("its uncertainty is {:.0f} % after {:.0f} s, so record longer",
                                  100.0 * fit->u_damping / fit->damping, duration);
    return peak;
  }
  // The centre of the power about its middle. Its u is the resolution of the window.
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
      "the peak is no wider than the resolution of {:.2g} Hz, so record longer than {:.0f} s, or a free decay",
      fine.resolution_hz, duration);
  return peak;
}

Taken about(const Peak& peak, const Spectrum& s) {
  const double half =
      std::max(2.0 * s.resolution_hz, std::isnan(peak.damping) ? 0.0 : 5.0 * peak.damping * peak.frequency_hz);
  return {peak.frequency_hz - half, peak.frequency_hz + half};
}

// Returns the band between a peak and its neighbours, or ten widths of it.
Taken own_band(double f, double lowest_hz, const std::vector<Taken>& taken, const Spectrum& s) {
  Taken own{std::max(lowest_hz, f - std::max(10.0 * s.resolution_hz, 0.5 * f)),
            std::min(s.frequency_hz.back(), f + std::max(10.0 * s.resolution_hz, 0.5 * f))};
  for (const Taken& t : taken) {
    if (t.to_hz < f) own.from_hz = std::max(own.from_hz, t.to_hz);
    if (t.from_hz > f) own.to_hz = std::min(own.to_hz, t.from_hz);
  }
  return own;
}

// Largest relative u of a frequency that counts. A slow step or a ramp leaves less certain ones. Chosen.
constexpr double kKnownWithin = 0.1;

// Removes the remains of steps and ramps. Next to a strong vibration they have no resolved shape and a small amplitude.
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

namespace {

// Finds peaks in the averaged spectrum, from `lowest_hz` up, and subtracts those that a fit explains from `series`.
std::vector<Peak> averaged_peaks(Series& series, const EvenTimes& times, const Spectrum& spectrum, double lowest_hz) {
  PeakFits fits(series, times);
  std::vector<Taken> taken;
  std::vector<Peak> found;
  Spectrum left = spectrum;
  while (found.size() < kMaxPeaks) {
    const auto near = next_peak(left, taken, lowest_hz);
    if (!near) break;
    if (fits.take(*near, left.resolution_hz)) {
      found.push_back(fits.last());
      left = *welch(fits.left(), times);  // cannot fail: the stretches are the same
    } else {
      found.push_back(random_peak(fits.left(), times, *near, own_band(*near, lowest_hz, taken, left)));
    }
    taken.push_back(about(found.back(), spectrum));
    // Prevents finding the same peak twice.
    taken.push_back({*near - spectrum.resolution_hz, *near + spectrum.resolution_hz});
  }
  fits.refine(found);
  leave_out_crumbs(found);
  series = fits.left();
  return found;
}

void subtract(Series& series, const SineFit& sine) {
  for (std::size_t i = 0; i < series.value.size(); ++i) series.value[i] -= sine.oscillation(series.time_s[i]);
}

}  // namespace

std::vector<Peak> peaks_of(const Series& series, const EvenTimes& times, const Spectrum& spectrum) {
  const double duration = static_cast<double>(times.longest().count) * times.interval_s;
  const double slowest = kMinCycles / duration, averaged_from = std::max(slowest, 1.5 * spectrum.resolution_hz);
  Series left = series;
  // Below the averaged spectrum first, because its leakage would look like further peaks.
  const auto slow = find_short_vibration(left, times, slowest, averaged_from);
  if (slow) subtract(left, slow->sine);
  std::vector<Peak> found = averaged_peaks(left, times, slow ? *welch(left, times) : spectrum, averaged_from);
  if (slow) found.push_back(slow->peak);
  const double few_hz = std::min(kFewCycles / duration, 0.4 / times.interval_s);
  const bool has_slow = std::any_of(found.begin(), found.end(), [&](const Peak& p) { return p.frequency_hz < few_hz; });
  if (!has_slow) {
    if (const auto missed = find_short_vibration(left, times, slowest, few_hz)) found.push_back(missed->peak);
  }
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
    const auto along = [&](double Extent<frame::Board>::*axis) {
      AxisSpectrum spectrum = spectrum_of(series_of(samples, target.marker, axis));
      // Lines, for example, show one axis only.
      if (!spectrum.refusal.empty() && std::isnan(target.u.*axis)) spectrum.refusal = "it was not measured";
      return spectrum;
    };
    spectra.push_back({along(&Extent<frame::Board>::x), along(&Extent<frame::Board>::y)});
  }
  return spectra;
}

}  // namespace moiregauge::internal
