// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/short_record.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include <fmt/format.h>

namespace moiregauge::internal {
namespace {

constexpr double kOmegaPerHz = 2.0 * std::numbers::pi;
constexpr double kByChance = 1e-7;          // probability of the fall of the sum of squares in noise
constexpr double kMaxSlowLeft = 0.1;        // largest remaining share of the slow motion; chosen
constexpr double kSlowReach = 2.0;          // slow motion extends to this multiple of the frequency; chosen
constexpr std::size_t kSineParameters = 5;  // a, b, c, d, omega

struct Residuals {
  std::vector<double> line, sine;  // with a straight line alone, and with the vibration
};

double square_sum(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return sum;
}

std::vector<double> without_line(const TimedValues& samples) {
  std::vector<double> left(samples.value.begin(), samples.value.end());
  const std::vector<double> line = slow_part(samples, 2.0 * (samples.time_s.back() - samples.time_s.front()));
  for (std::size_t i = 0; i < left.size(); ++i) left[i] -= line[i];
  return left;
}

// Returns the power of a periodogram from its first ordinate to `to_hz`, and the number of ordinates.
struct SlowPower {
  double sum = 0.0;
  std::size_t ordinates = 0;
  [[nodiscard]] double mean() const { return ordinates > 0 ? sum / static_cast<double>(ordinates) : 0.0; }
};
SlowPower slow_power(const std::vector<double>& values, double interval_s, double to_hz) {
  const Spectrum s = periodogram(values.data(), values.size(), interval_s);
  SlowPower slow;
  for (std::size_t k = 1; k < s.psd.size() && s.frequency_hz[k] <= to_hz; ++k) {
    slow.sum += s.psd[k];
    ++slow.ordinates;
  }
  return slow;
}

// Probability that white noise gives as large a fall of the sum of squares (R. A. Fisher, Proc. R. Soc. A 125, 1929,
// 54-59), for `trials` independent frequencies.
double chance_of(const Residuals& left, double trials) {
  const double ratio = square_sum(left.sine) / square_sum(left.line);
  const double half = 0.5 * (static_cast<double>(left.line.size()) - static_cast<double>(kSineParameters));
  return trials * std::pow(ratio, half);
}

Residuals residuals_of(const TimedValues& samples, const SineFit& fit) {
  Residuals left{without_line(samples), {}};
  for (std::size_t i = 0; i < samples.value.size(); ++i) left.sine.push_back(samples.value[i] - fit(samples.time_s[i]));
  return left;
}

// Returns the noise variance of one sample: that of all residuals, or that of the slow ones if it is larger.
double noise_variance(const std::vector<double>& left, double interval_s, double to_hz) {
  const double white = square_sum(left) / static_cast<double>(left.size() - kSineParameters);
  return std::max(white, slow_power(left, interval_s, to_hz).mean() / (2.0 * interval_s));
}

}  // namespace

std::optional<ShortVibration> find_short_vibration(const Series& series, const EvenTimes& times, double lowest_hz,
                                                   double highest_hz) {
  const Stretch& all = times.longest();
  const double duration = static_cast<double>(all.count) * times.interval_s;
  if (all.count < kMinSamples || all.count > kMaxFitted || !(lowest_hz < highest_hz)) return std::nullopt;
  const TimedValues samples{std::span(series.time_s).subspan(all.first, all.count),
                            std::span(series.value).subspan(all.first, all.count)};
  const double start = best_omega(samples, kOmegaPerHz * lowest_hz, kOmegaPerHz * highest_hz);
  const auto sine = fit_sine(samples, start, Decaying::kNo);
  if (!sine) return std::nullopt;
  const Residuals left = residuals_of(samples, *sine);
  const double f = sine->omega / kOmegaPerHz, slow_hz = kSlowReach * f;
  if (f < lowest_hz || f > highest_hz) return std::nullopt;
  if (chance_of(left, 2.0 * duration * (highest_hz - lowest_hz)) > kByChance) return std::nullopt;
  if (slow_power(left.sine, times.interval_s, slow_hz).sum >
      kMaxSlowLeft * slow_power(left.line, times.interval_s, slow_hz).sum)
    return std::nullopt;
  const Eigen::Matrix2d spread = noise_variance(left.sine, times.interval_s, slow_hz) * sine->spread;
  Peak peak;
  peak.kind = PeakKind::kSteady;
  peak.frequency_hz = f;
  peak.u_frequency_hz = std::sqrt(spread(0, 0)) / kOmegaPerHz;
  peak.amplitude_mm = sine->amplitude();
  peak.from_s = samples.time_s.front();
  peak.to_s = samples.time_s.back();
  peak.no_damping = fmt::format("the record holds only {:.1f} cycles, so record longer", f * duration);
  return ShortVibration{*sine, peak};
}

}  // namespace moiregauge::internal
