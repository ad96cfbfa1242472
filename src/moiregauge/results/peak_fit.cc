// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/peak_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <fmt/format.h>

namespace moiregauge::internal {
namespace {

constexpr double kTurnsPerHz = 2.0 * std::numbers::pi;
constexpr double kBlockCycles = 2.0;      // length of a block of the amplitude history, cycles; chosen
constexpr std::size_t kBlockSamples = 8;  // least length of a block, samples; chosen
constexpr double kRises = 1.5;            // rise over the least block before that shows a new impact; chosen
constexpr double kFallsBy = 0.5;          // least lambda times duration: a fall by 40 %; chosen
constexpr double kSlowCycles = 4.0;       // distance of the knots of the slow part, cycles; chosen
constexpr int kSlowPasses = 3;            // each pass reduces the sine's share in the slow part by 1 / (2 pi 4)^2
// Least lambda in its standard uncertainties. With 3, accepted values would be too large by half a u on average.
constexpr double kSignificant = 5.0;
constexpr double kMaxLeft = 0.01;         // largest remaining power about its frequency, relative; chosen
constexpr double kMinProminence = 6.0;    // times the level around: chance exceeds it about once in 10^7
constexpr double kMisfit = 3.0;           // remaining power at the peak, times the level, that counts as noise; chosen
constexpr double kFurthestBack = 3.0;     // limit of extrapolating a decay back, times its start amplitude; chosen
constexpr std::size_t kNear = 3;          // ordinates to each side that belong to the peak
constexpr std::size_t kNoiseAround = 40;  // further ordinates to each side, for the noise level; chosen

struct Gathered {
  std::vector<double> time_s, value;
  std::vector<std::size_t> row;  // row in the series
  [[nodiscard]] TimedValues view() const { return {time_s, value}; }
};

Gathered gathered(const Series& series, std::size_t first, std::size_t count) {
  Gathered g;
  for (std::size_t i = first; i < first + count; ++i) {
    if (std::isnan(series.value[i])) continue;
    g.time_s.push_back(series.time_s[i]);
    g.value.push_back(series.value[i]);
    g.row.push_back(i);
  }
  return g;
}

// A sine and the slow part of the motion, fitted in turn with the other subtracted.
struct OnSlow {
  std::optional<SineFit> sine;
  std::vector<double> slow;  // one value per sample
};

Gathered without(const Gathered& g, const std::vector<double>& taken) {
  Gathered left = g;
  for (std::size_t i = 0; i < taken.size(); ++i) left.value[i] -= taken[i];
  return left;
}

OnSlow fit_on_slow(const Gathered& g, double omega, Decaying decaying) {
  const double spacing = kSlowCycles * kTurnsPerHz / omega;
  OnSlow fit{std::nullopt, slow_part(g.view(), spacing)};
  for (int pass = 0; pass < kSlowPasses; ++pass) {
    fit.sine = fit_sine(without(g, fit.slow).view(), fit.sine ? fit.sine->omega : omega, decaying);
    if (!fit.sine) return fit;
    std::vector<double> swing;
    for (const double t : g.time_s) swing.push_back(fit.sine->oscillation(t));
    fit.slow = slow_part(without(g, swing).view(), spacing);
  }
  return fit;
}

struct Surroundings {
  double near = 0.0, around = 0.0;  // mean residual density at the peak, and on both sides of it, mm^2/Hz
};

Surroundings surroundings_of(const std::vector<double>& left, double frequency_hz, double interval_s) {
  const Spectrum s = periodogram(left.data(), left.size(), interval_s);
  const auto middle = std::lround(frequency_hz / s.frequency_hz[1]);
  double near = 0.0, around = 0.0;
  long near_count = 0, around_count = 0;
  for (long k = 1; k + 1 < static_cast<long>(s.psd.size()); ++k) {
    const auto off = static_cast<std::size_t>(std::abs(k - middle));
    if (off <= kNear) near += s.psd[static_cast<std::size_t>(k)], ++near_count;
    if (off > kNear && off <= kNear + kNoiseAround) around += s.psd[static_cast<std::size_t>(k)], ++around_count;
  }
  return {near_count > 0 ? near / static_cast<double>(near_count) : 0.0,
          around_count > 0 ? around / static_cast<double>(around_count) : 0.0};
}

// Returns the longest part of a window without a gap.
Stretch longest_in(const EvenTimes& times, std::size_t first, std::size_t count) {
  Stretch best;
  for (const Stretch& s : times.stretches) {
    const std::size_t from = std::max(first, s.first), to = std::min(first + count, s.first + s.count);
    if (to > from && to - from > best.count) best = {from, to - from};
  }
  return best;
}

std::string not_falling(const SineFit& fit, double u_lambda, double duration) {
  return fmt::format("the vibration is steady, its amplitude only {} by {:.1f} % (u {:.1f} %)",
                     fit.lambda >= 0.0 ? "falls" : "grows", 100.0 * std::abs(std::expm1(-fit.lambda * duration)),
                     100.0 * u_lambda * duration);
}

}  // namespace

PeakFits::PeakFits(const Series& series, const EvenTimes& times) : times_(times), left_(series) {
  all_ = {times.stretches.front().first,
          times.stretches.back().first + times.stretches.back().count - times.stretches.front().first};
  all_.count = std::min(all_.count, kMaxFitted);
}

// Returns the rows from the highest block to the next impact or the end.
PeakFits::Window PeakFits::falling_part(double omega) const {
  const double per_cycle = kTurnsPerHz / (omega * times_.interval_s);
  const std::size_t block = std::max(kBlockSamples, static_cast<std::size_t>(std::ceil(kBlockCycles * per_cycle)));
  std::vector<double> amplitude;
  for (std::size_t at = 0; at + block <= all_.count; at += block) {
    const Gathered g = gathered(left_, all_.first + at, block);
    double c = 0.0, s = 0.0, mean = 0.0;
    for (const double v : g.value) mean += v / static_cast<double>(g.value.size());
    for (std::size_t i = 0; i < g.value.size(); ++i) {
      c += (g.value[i] - mean) * std::cos(omega * g.time_s[i]);
      s += (g.value[i] - mean) * std::sin(omega * g.time_s[i]);
    }
    amplitude.push_back(g.value.empty() ? 0.0 : 2.0 * std::hypot(c, s) / static_cast<double>(g.value.size()));
  }
  if (amplitude.size() < 3) return all_;
  const auto top = static_cast<std::size_t>(std::max_element(amplitude.begin(), amplitude.end()) - amplitude.begin());
  // Noise may rise below `floor`. Below `over` the vibration has ended.
  const double floor = 0.05 * amplitude[top], over = 0.03 * amplitude[top];
  double least = amplitude[top];
  std::size_t end = top + 1;
  for (; end < amplitude.size(); ++end) {
    if (amplitude[end] > kRises * std::max(least, floor)) break;
    least = std::min(least, amplitude[end]);
    if (least < over) break;
  }
  const std::size_t begin = top == 0 ? 0 : top + 1;  // the impact may be in the highest block
  if (begin >= end) return all_;
  const std::size_t to = end == amplitude.size() ? all_.count : end * block;
  return {all_.first + begin * block, to - begin * block};
}

// Extends a window back to the row from which the oscillation, extrapolated backwards, explains most.
PeakFits::Window PeakFits::from_impact(Window window, const SineFit& sine, double level) const {
  Window best = window;
  double gain = 0.0, most = 0.0;
  for (std::size_t i = window.first; i-- > all_.first;) {
    const double model = sine.oscillation(left_.time_s[i]), value = left_.value[i];
    const double before = value - level;
    if (std::isnan(value) || std::exp(sine.lambda * (left_.time_s[window.first] - left_.time_s[i])) > kFurthestBack)
      break;
    gain += before * before - (before - model) * (before - model);
    if (gain <= most) continue;
    most = gain;
    best = {i, window.first + window.count - i};
  }
  return best;
}

bool PeakFits::try_fit(Window window, double omega, Decaying decaying) {
  const Gathered g = gathered(left_, window.first, window.count);
  const auto [sine, slow] = fit_on_slow(g, omega, decaying);
  if (!sine) return false;
  const Stretch even = longest_in(times_, window.first, window.count);
  if (even.count < kMinSamples) return false;
  std::vector<double> left, taken;
  for (std::size_t i = 0; i < g.value.size(); ++i) {
    if (g.row[i] < even.first || g.row[i] >= even.first + even.count) continue;
    taken.push_back(sine->oscillation(g.time_s[i]));
    left.push_back(g.value[i] - slow[i] - taken.back());
  }
  const double f = sine->omega / kTurnsPerHz;
  const Surroundings rest = surroundings_of(left, f, times_.interval_s);
  const double power = surroundings_of(taken, f, times_.interval_s).near;
  if (rest.near > std::max(kMaxLeft * power, kMinProminence * rest.around)) return false;
  if (power < kMinProminence * rest.around) return false;
  // Noise of one sample, assumed white with the density at this frequency.
  const double density = rest.near > kMisfit * rest.around ? rest.near : rest.around;
  const double variance = density / (2.0 * times_.interval_s);
  const double duration = g.time_s.back() - g.time_s.front();
  Fit fit{*sine, {}, window, decaying == Decaying::kYes ? from_impact(window, *sine, slow.front()) : window};
  Peak& peak = fit.peak;
  peak.from_s = g.time_s.front();
  peak.to_s = g.time_s.back();
  peak.amplitude_mm = sine->amplitude();
  const Eigen::Matrix2d spread = variance * sine->spread;
  if (decaying == Decaying::kNo) {
    peak.kind = PeakKind::kSteady;
    peak.frequency_hz = f;
    peak.u_frequency_hz = std::sqrt(spread(0, 0)) / kTurnsPerHz;
    const auto slope = fit_sine(without(g, slow).view(), sine->omega, Decaying::kYes);
    if (slope) peak.no_damping = not_falling(*slope, std::sqrt(variance * slope->spread(1, 1)), duration);
  } else {
    const double u_lambda = std::sqrt(spread(1, 1));
    if (!(sine->lambda > kSignificant * u_lambda) || !(sine->lambda * duration > kFallsBy)) return false;
    peak.kind = PeakKind::kDecay;
    const double natural = std::hypot(sine->omega, sine->lambda);
    const Eigen::Vector2d by_natural(sine->omega / natural, sine->lambda / natural);
    const double zeta = sine->lambda / natural;
    const Eigen::Vector2d by_zeta(-zeta * sine->omega / (natural * natural),
                                  sine->omega * sine->omega / (natural * natural * natural));
    peak.frequency_hz = natural / kTurnsPerHz;
    peak.u_frequency_hz = std::sqrt(by_natural.dot(spread * by_natural)) / kTurnsPerHz;
    peak.damping = zeta;
    peak.u_damping = std::sqrt(by_zeta.dot(spread * by_zeta));
  }
  fits_.push_back(std::move(fit));
  return true;
}

void PeakFits::add(const Fit& fit, double sign) {
  for (std::size_t i = fit.taken.first; i < fit.taken.first + fit.taken.count; ++i)
    left_.value[i] += sign * fit.sine.oscillation(left_.time_s[i]);  // a gap stays NaN
}

bool PeakFits::take(double near_hz, double resolution_hz) {
  const double lowest = kTurnsPerHz * std::max(near_hz - resolution_hz, 0.3 * near_hz);
  const double highest = kTurnsPerHz * (near_hz + resolution_hz);
  const Window decaying = falling_part(kTurnsPerHz * near_hz);
  for (const Window& window : {decaying, all_}) {
    const Gathered g = gathered(left_, window.first, window.count);
    if (g.value.size() < kMinSamples) continue;
    const auto slow = slow_part(g.view(), kSlowCycles / near_hz);
    const double omega = best_omega(without(g, slow).view(), lowest, highest);
    const bool is_whole = window.first == all_.first && window.count == all_.count;
    if (try_fit(window, omega, Decaying::kYes) || (is_whole && try_fit(window, omega, Decaying::kNo))) {
      add(fits_.back(), -1.0);
      return true;
    }
    if (is_whole) break;
  }
  return false;
}

void PeakFits::refine(std::vector<Peak>& found) {
  if (fits_.size() < 2) return;
  std::vector<Fit> first = std::move(fits_);
  fits_.clear();
  for (Fit& fit : first) {
    add(fit, 1.0);
    const auto was = std::find_if(found.begin(), found.end(),
                                  [&](const Peak& p) { return p.frequency_hz == fit.peak.frequency_hz; });
    const Decaying decaying = fit.peak.kind == PeakKind::kDecay ? Decaying::kYes : Decaying::kNo;
    if (try_fit(fit.fitted, fit.sine.omega, decaying)) {
      add(fits_.back(), -1.0);
      if (was != found.end()) *was = fits_.back().peak;
    } else {
      add(fit, -1.0);
    }
  }
}

}  // namespace moiregauge::internal
