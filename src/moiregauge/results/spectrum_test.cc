// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/peaks.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "moiregauge/results/random_fit.h"
#include "moiregauge/results/short_record.h"

namespace moiregauge::internal {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr int kDraws = 200;
// The scatter of n pulls has a relative standard error of 1 / sqrt(2 n), their mean one of 1 / sqrt(n). The limits are
// four times these. The noise comes from 80 correlated ordinates, which adds 8 % of u.
constexpr double kOfScatter = 4.0 / 20.0 + 0.08;
constexpr double kOfMean = 4.0 / 14.14;

using Signal = double (*)(double t);

Series sampled(Signal signal, std::size_t count, double fps, double noise, std::mt19937_64& rng) {
  std::normal_distribution<double> normal(0.0, noise);
  Series series;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / fps;
    series.time_s.push_back(t);
    series.value.push_back(signal(t) + normal(rng));
  }
  return series;
}

double vibration(double t) { return 0.5 * std::sin(kTwoPi * 1.7 * t + 0.4); }
double decay(double t) {  // damping ratio 1 %, 1.7 Hz
  const double omega = kTwoPi * 1.7;
  return 0.5 * std::exp(-0.01 * omega * t) * std::cos(omega * std::sqrt(1.0 - 1e-4) * t + 1.0);
}
double nothing(double) { return 0.0; }

// An oscillator driven by white noise, computed in many small steps between the samples.
Series driven(double f0, double zeta, std::size_t count, double fps, std::mt19937_64& rng) {
  std::normal_distribution<double> normal;
  constexpr int kSteps = 16;
  const double omega = kTwoPi * f0, h = 1.0 / (fps * kSteps);
  const double e = std::exp(-zeta * omega * h), w = omega * std::sqrt(1.0 - zeta * zeta);
  const double c = std::cos(w * h), s = std::sin(w * h), ratio = zeta * omega / w;
  double x = 0.0, v = 0.0;
  Series series;
  const auto warm = static_cast<std::size_t>(3.0 * fps / (zeta * omega));
  for (std::size_t i = 0; i < count + warm; ++i) {
    for (int k = 0; k < kSteps; ++k) {
      const double x1 = e * ((c + ratio * s) * x + s / w * v);
      v = e * ((c - ratio * s) * v - omega * omega / w * s * x) + std::sqrt(h) * normal(rng);
      x = x1;
    }
    if (i < warm) continue;
    series.time_s.push_back(static_cast<double>(i - warm) / fps);
    series.value.push_back(x);
  }
  return series;
}

struct Pulls {
  double sum = 0.0, squares = 0.0;
  int count = 0;
  void add(double pull) {
    sum += pull;
    squares += pull * pull;
    ++count;
  }
  void expect_normal() const {
    EXPECT_EQ(count, kDraws);
    EXPECT_NEAR(sum / count, 0.0, kOfMean);
    EXPECT_NEAR(std::sqrt(squares / count), 1.0, kOfScatter);
  }
};

TEST(Spectrum, TheIntegralOfItIsTheVariance) {
  std::mt19937_64 rng(1);
  const AxisSpectrum found = spectrum_of(sampled(nothing, 4000, 50.0, 0.01, rng));
  ASSERT_EQ(found.refusal, "");
  double integral = 0.0;
  for (const double psd : found.spectrum.psd) integral += psd * found.spectrum.frequency_hz[1];
  // White noise has a density of 2 sigma^2 / fps everywhere. The variance of 4000 values has a relative u of sqrt(2 /
  // 4000). The window uses a part of the data, so allow for half as many.
  EXPECT_NEAR(integral / 1e-4, 1.0, 4.0 * std::sqrt(2.0 / 2000.0));
  EXPECT_NEAR(found.spectrum.resolution_hz, 1.5 * 50.0 / static_cast<double>(found.spectrum.segment_samples), 1e-12);
  EXPECT_TRUE(found.peaks.empty());
}

TEST(Spectrum, NoiseAloneHasNoPeaks) {
  std::mt19937_64 rng(2);
  int peaks = 0;
  for (int draw = 0; draw < 200; ++draw) peaks += int(spectrum_of(sampled(nothing, 200, 10.0, 0.01, rng)).peaks.size());
  EXPECT_EQ(peaks, 0);  // 200 draws of 30 ordinates at 1e-7 each
}

TEST(Spectrum, ASteadyVibrationIsFoundWithAnUncertaintyThatHolds) {
  std::mt19937_64 rng(3);
  Pulls pulls;
  for (int draw = 0; draw < kDraws; ++draw) {
    const AxisSpectrum found = spectrum_of(sampled(vibration, 160, 10.0, 0.01, rng));
    ASSERT_EQ(found.peaks.size(), 1U);
    const Peak& peak = found.peaks.front();
    EXPECT_EQ(peak.kind, PeakKind::kSteady);
    EXPECT_NEAR(peak.frequency_hz, 1.7, 0.005 * 1.7);
    EXPECT_TRUE(std::isnan(peak.damping));
    EXPECT_NE(peak.no_damping, "");
    // Cramer-Rao bound of Rife and Boorstyn: sqrt(6 / N) sigma / (pi A T). The noise has a u of 8 %, and the limit is
    // four times that. Once in 300 draws chance looks like a misfit of up to six times the density of the noise. That
    // inflates u by up to sqrt(6).
    const double bound = std::sqrt(6.0 / 160.0) * 0.01 / (std::numbers::pi * 0.5 * 16.0);
    EXPECT_GT(peak.u_frequency_hz, 0.68 * bound);
    EXPECT_LT(peak.u_frequency_hz, 2.45 * 1.32 * bound);
    pulls.add((peak.frequency_hz - 1.7) / peak.u_frequency_hz);
  }
  pulls.expect_normal();
}

TEST(Spectrum, AFreeDecayGivesItsDampingWithAnUncertaintyThatHolds) {
  std::mt19937_64 rng(4);
  Pulls of_frequency, of_damping;
  for (int draw = 0; draw < kDraws; ++draw) {
    const AxisSpectrum found = spectrum_of(sampled(decay, 200, 10.0, 0.01, rng));
    ASSERT_EQ(found.peaks.size(), 1U);
    const Peak& peak = found.peaks.front();
    ASSERT_EQ(peak.kind, PeakKind::kDecay);
    EXPECT_NEAR(peak.frequency_hz, 1.7, 0.005 * 1.7);
    EXPECT_NEAR(peak.damping, 0.01, 0.001);
    of_frequency.add((peak.frequency_hz - 1.7) / peak.u_frequency_hz);
    of_damping.add((peak.damping - 0.01) / peak.u_damping);
  }
  of_frequency.expect_normal();
  of_damping.expect_normal();
}

TEST(Spectrum, ADecayIsFoundAfterAnImpactAtAnyTime) {
  std::mt19937_64 rng(5);
  const auto struck = [](double t) { return t < 7.3 ? 0.0 : decay(t - 7.3); };
  const AxisSpectrum found = spectrum_of(sampled(struck, 300, 10.0, 0.005, rng));
  ASSERT_EQ(found.peaks.size(), 1U);
  EXPECT_EQ(found.peaks.front().kind, PeakKind::kDecay);
  EXPECT_GT(found.peaks.front().from_s, 7.3);
  EXPECT_NEAR(found.peaks.front().damping, 0.01, 4.0 * found.peaks.front().u_damping);
}

TEST(Spectrum, ARandomlyDrivenOscillatorGivesBothWithUncertaintiesThatHold) {
  std::mt19937_64 rng(6);
  Pulls of_frequency, of_damping;
  for (int draw = 0; draw < kDraws; ++draw) {
    const Series series = driven(0.5, 0.04, 800, 2.5, rng);
    const Spectrum fine = periodogram(series.value.data(), series.value.size(), 0.4);
    const auto fit = fit_random(fine, 0.5, 0.25, 0.75);
    ASSERT_TRUE(fit);
    of_frequency.add((fit->frequency_hz - 0.5) / fit->u_frequency_hz);
    of_damping.add(std::log(fit->damping / 0.04) / (fit->u_damping / fit->damping));
  }
  of_frequency.expect_normal();
  of_damping.expect_normal();
}

TEST(Spectrum, AmbientVibrationIsCalledRandom) {
  std::mt19937_64 rng(7);
  const AxisSpectrum found = spectrum_of(driven(1.0, 0.02, 3000, 5.0, rng));
  ASSERT_EQ(found.peaks.size(), 1U);
  EXPECT_EQ(found.peaks.front().kind, PeakKind::kRandom);
  EXPECT_NEAR(found.peaks.front().frequency_hz, 1.0, 4.0 * found.peaks.front().u_frequency_hz);
  EXPECT_NEAR(found.peaks.front().damping, 0.02, 4.0 * found.peaks.front().u_damping);
}

TEST(Spectrum, DampingOfAShortAmbientRecordIsRefused) {
  std::mt19937_64 rng(8);
  const AxisSpectrum found = spectrum_of(driven(1.0, 0.005, 200, 5.0, rng));  // 40 s; the peak is 0.01 Hz wide
  ASSERT_GE(found.peaks.size(), 1U);
  for (const Peak& peak : found.peaks) {
    if (peak.kind != PeakKind::kRandom) continue;
    EXPECT_TRUE(std::isnan(peak.damping));
    EXPECT_NE(peak.no_damping, "");
  }
}

TEST(Spectrum, AVibrationOnATargetThatTravelsIsTheSame) {
  std::mt19937_64 rng(14);
  const auto travelling = [](double t) {
    return vibration(t) + (t < 6.0 ? t / 3.0 : t < 10.0 ? 2.0 : 2.0 - (t - 10.0) / 4.0);
  };
  const AxisSpectrum found = spectrum_of(sampled(travelling, 180, 10.0, 0.001, rng));
  const auto nearest = std::min_element(found.peaks.begin(), found.peaks.end(), [](const Peak& a, const Peak& b) {
    return std::abs(a.frequency_hz - 1.7) < std::abs(b.frequency_hz - 1.7);
  });
  ASSERT_NE(nearest, found.peaks.end());
  EXPECT_EQ(nearest->kind, PeakKind::kSteady);
  EXPECT_NEAR(nearest->frequency_hz, 1.7, 4.0 * nearest->u_frequency_hz);
  EXPECT_NEAR(nearest->amplitude_mm, 0.5, 0.01);
}

// The paper's programme: up by 1 mm, a rest, up again, and down in the same way, in 16 s.
TEST(Spectrum, StepsAndRampsAreNoVibration) {
  std::mt19937_64 rng(15);
  const auto stairs = [](double t) {
    const auto ramp = [](double since) { return std::clamp(since / 2.0, 0.0, 1.0); };
    return ramp(t) + ramp(t - 4.0) - ramp(t - 8.0) - ramp(t - 12.0);
  };
  const AxisSpectrum found = spectrum_of(sampled(stairs, 161, 10.0, 0.0005, rng));
  EXPECT_EQ(found.refusal, "");
  for (const Peak& peak : found.peaks)
    ADD_FAILURE() << peak.frequency_hz << " Hz, u " << peak.u_frequency_hz << " Hz, " << peak.amplitude_mm << " mm";
}

TEST(Spectrum, TwoVibrationsDoNotDisturbEachOther) {
  std::mt19937_64 rng(9);
  const auto both = [](double t) { return vibration(t) + 0.1 * std::sin(kTwoPi * 2.3 * t); };
  const AxisSpectrum found = spectrum_of(sampled(both, 300, 10.0, 0.005, rng));
  ASSERT_EQ(found.peaks.size(), 2U);
  EXPECT_NEAR(found.peaks[0].frequency_hz, 1.7, 4.0 * found.peaks[0].u_frequency_hz);
  EXPECT_NEAR(found.peaks[1].frequency_hz, 2.3, 4.0 * found.peaks[1].u_frequency_hz);
}

// The noise has 155 degrees of freedom, so that u is right within 6 %.
TEST(Spectrum, AFewCyclesGiveTheFrequencyWithAnUncertaintyThatHolds) {
  std::mt19937_64 rng(21);
  for (const double cycles : {3.2, 4.5, 6.0, 7.9}) {
    int inside = 0, named = 0;
    for (int draw = 0; draw < kDraws; ++draw) {
      std::uniform_real_distribution<double> phase(0.0, kTwoPi);
      const double f = cycles / 16.0, start = phase(rng);
      Series series = sampled(nothing, 160, 10.0, 0.01, rng);
      for (std::size_t i = 0; i < series.value.size(); ++i)
        series.value[i] += 0.1 * std::sin(kTwoPi * f * series.time_s[i] + start) + 0.002 * series.time_s[i];
      const AxisSpectrum found = spectrum_of(series);
      if (found.peaks.size() != 1) continue;
      ++named;
      inside += std::abs(found.peaks.front().frequency_hz - f) < 2.0 * found.peaks.front().u_frequency_hz;
    }
    EXPECT_EQ(named, kDraws) << cycles;
    // 95 % of 200 draws, less four standard errors of 1.5 % each.
    EXPECT_GE(inside, 0.89 * kDraws) << cycles;
    std::printf("%.1f cycles: %d of %d inside U\n", cycles, inside, named);
  }
}

// A quarter of an averaged spectrum's segments is slower than its resolution. Noise, random walks, single bumps and
// steps must not be named there.
TEST(Spectrum, DriftOfAShortRecordIsNoVibration) {
  std::mt19937_64 rng(22);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> any(0.0, 1.0);
  int named = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    Series walk = sampled(nothing, 160, 10.0, 0.01, rng), bump = walk, step = walk, noise = walk;
    const double middle = 16.0 * any(rng), width = 0.5 + 2.0 * any(rng);
    double level = 0.0;
    for (std::size_t i = 0; i < walk.value.size(); ++i) {
      const double t = walk.time_s[i];
      level += 0.02 * normal(rng);
      walk.value[i] += level;
      bump.value[i] += std::exp(-0.5 * (t - middle) * (t - middle) / (width * width));
      step.value[i] += t > middle ? 1.0 : 0.0;
    }
    for (const Series* one : {&walk, &bump, &step, &noise}) {
      const AxisSpectrum found = spectrum_of(*one);
      for (const Peak& peak : found.peaks) named += peak.frequency_hz < kFewCycles / 16.0;
    }
  }
  EXPECT_EQ(named, 0);
}

TEST(Spectrum, GapsAreExcludedAndNeverFilled) {
  std::mt19937_64 rng(10);
  Series series = sampled(vibration, 400, 10.0, 0.01, rng);
  for (std::size_t i = 100; i < 110; ++i) series.value[i] = kNotMeasured;      // rows that are not ok
  series.value.erase(series.value.begin() + 250, series.value.begin() + 253);  // and missing frames
  series.time_s.erase(series.time_s.begin() + 250, series.time_s.begin() + 253);
  const auto times = even_times(series);
  ASSERT_TRUE(times);
  ASSERT_EQ(times->stretches.size(), 3U);
  EXPECT_EQ(times->longest().count, 147U);
  const AxisSpectrum found = spectrum_of(series);
  EXPECT_EQ(found.gaps, 2U);
  ASSERT_EQ(found.peaks.size(), 1U);
  EXPECT_NEAR(found.peaks.front().frequency_hz, 1.7, 4.0 * found.peaks.front().u_frequency_hz);
}

TEST(Spectrum, TimesThatAreNotEvenAreRefusedWithTheReason) {
  std::mt19937_64 rng(11);
  Series series = sampled(vibration, 100, 10.0, 0.01, rng);
  std::uniform_real_distribution<double> early(-0.03, 0.03);
  for (double& t : series.time_s) t += early(rng);
  EXPECT_NE(spectrum_of(series).refusal.find("from an even grid"), std::string::npos);
  for (double& t : series.time_s) t = kNotMeasured;
  EXPECT_NE(spectrum_of(series).refusal.find("--fps"), std::string::npos);
}

TEST(Spectrum, MillisecondsAreEvenEnough) {
  std::mt19937_64 rng(12);
  Series series = sampled(vibration, 2000, 240.0, 0.01, rng);
  for (double& t : series.time_s) t = std::round(1000.0 * t) / 1000.0;
  EXPECT_EQ(spectrum_of(series).refusal, "");
}

TEST(Spectrum, AHandfulOfFramesIsRefusedWithTheReason) {
  std::mt19937_64 rng(13);
  EXPECT_NE(spectrum_of(sampled(vibration, 20, 10.0, 0.01, rng)).refusal.find("32 are needed"), std::string::npos);
}

}  // namespace
}  // namespace moiregauge::internal
