// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/random_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace moiregauge::internal {
namespace {

constexpr double kCorrelated = 1.0 + 2.0 * (4.0 / 9.0 + 1.0 / 36.0);  // 1.94: correlated ordinates
constexpr int kRandomPasses = 40;          // largest number of Levenberg-Marquardt steps; chosen
constexpr std::size_t kMinOrdinates = 12;  // three per parameter; chosen

using Four = Eigen::Vector4d;  // ln S0, ln f0, ln zeta, ln B

// |W|^2 of the Hann window at quarters of a bin from its middle, with the sum 1. It smears the spectrum.
class Smear {
 public:
  static constexpr int kQuarters = 8;  // two bins to each side
  Smear() {
    double sum = 0.0;
    for (int q = -kQuarters; q <= kQuarters; ++q) sum += at(q) = power(0.25 * q);
    for (double& weight : weight_) weight /= sum;
  }
  [[nodiscard]] double operator[](int quarter) const { return weight_[static_cast<std::size_t>(quarter + kQuarters)]; }

 private:
  double& at(int quarter) { return weight_[static_cast<std::size_t>(quarter + kQuarters)]; }
  static double sinc(double x) { return x == 0.0 ? 1.0 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x); }
  static double power(double bins) {
    const double w = sinc(bins) + 0.5 * (sinc(bins - 1.0) + sinc(bins + 1.0));
    return w * w;
  }
  std::array<double, 2 * kQuarters + 1> weight_{};
};

struct Band {
  std::vector<double> frequency_hz, psd;
  double bin_hz = 0.0;
};

double response(double frequency_hz, double f0, double zeta) {
  const double beta = frequency_hz / f0, off = 1.0 - beta * beta, width = 2.0 * zeta;
  return width * width / (off * off + width * width * beta * beta);
}

// S and its derivatives by the four parameters, at one ordinate.
struct Expected {
  double s = 0.0;
  Four by;
};

Expected expected(const Four& p, double frequency_hz, double bin_hz, const Smear& smear) {
  const double f0 = std::exp(p[1]), zeta = std::exp(p[2]), s0 = std::exp(p[0]), base = std::exp(p[3]);
  constexpr double kStep = 1e-5;  // relative step of the central differences; chosen
  double value = 0.0, by_f0 = 0.0, by_zeta = 0.0;
  for (int q = -Smear::kQuarters; q <= Smear::kQuarters; ++q) {
    const double f = frequency_hz + 0.25 * q * bin_hz, weight = smear[q];
    value += weight * response(f, f0, zeta);
    by_f0 += weight * (response(f, f0 * (1.0 + kStep), zeta) - response(f, f0 * (1.0 - kStep), zeta));
    by_zeta += weight * (response(f, f0, zeta * (1.0 + kStep)) - response(f, f0, zeta * (1.0 - kStep)));
  }
  return {s0 * value + base, Four(s0 * value, s0 * by_f0 / (2.0 * kStep), s0 * by_zeta / (2.0 * kStep), base)};
}

struct Likelihood {
  double minus_log = 0.0;
  Four gradient = Four::Zero();
  Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
};

Likelihood likelihood(const Band& band, const Four& p, const Smear& smear) {
  Likelihood l;
  for (std::size_t k = 0; k < band.psd.size(); ++k) {
    const Expected e = expected(p, band.frequency_hz[k], band.bin_hz, smear);
    const double ratio = band.psd[k] / e.s;
    const Four by = e.by / e.s;
    l.minus_log += std::log(e.s) + ratio;
    l.gradient += (1.0 - ratio) * by;
    l.information += by * by.transpose();
  }
  return l;
}

Band band_of(const Spectrum& of_all, double lowest_hz, double highest_hz) {
  Band band;
  band.bin_hz = of_all.frequency_hz[1];
  for (std::size_t k = 1; k + 1 < of_all.psd.size(); ++k) {
    const double f = of_all.frequency_hz[k];
    if (f < lowest_hz || f > highest_hz || !(of_all.psd[k] > 0.0)) continue;
    band.frequency_hz.push_back(f);
    band.psd.push_back(of_all.psd[k]);
  }
  return band;
}

// Returns the start values: width from power divided by height, floor from the lower quarter.
Four begin(const Band& band, double around_hz) {
  std::vector<double> sorted = band.psd;
  std::sort(sorted.begin(), sorted.end());
  const double base = sorted[sorted.size() / 4] / 0.29;  // the lower quartile of an exponential distribution is 0.29
  double height = 0.0, power = 0.0;
  for (std::size_t k = 0; k < band.psd.size(); ++k) {
    power += std::max(0.0, band.psd[k] - base) * band.bin_hz;
    if (std::abs(band.frequency_hz[k] - around_hz) < 1.5 * band.bin_hz) height = std::max(height, band.psd[k]);
  }
  height = std::max(height, sorted.back() * 0.2);
  const double zeta = std::clamp(power / (std::numbers::pi * height * around_hz), 1e-4, 0.3);
  return {std::log(height), std::log(around_hz), std::log(zeta), std::log(base)};
}

}  // namespace

double RandomFit::rms() const { return std::sqrt(peak * std::numbers::pi * damping * frequency_hz); }

std::optional<RandomFit> fit_random(const Spectrum& of_all, double around_hz, double lowest_hz, double highest_hz) {
  const Band band = band_of(of_all, lowest_hz, highest_hz);
  if (band.psd.size() < kMinOrdinates) return std::nullopt;
  static const Smear smear;
  Four p = begin(band, around_hz);
  Likelihood here = likelihood(band, p, smear);
  double damp = 1e-3;  // Levenberg-Marquardt
  for (int pass = 0; pass < kRandomPasses; ++pass) {
    Eigen::Matrix4d m = here.information;
    m.diagonal() *= 1.0 + damp;
    const Four step = -m.ldlt().solve(here.gradient);
    if (!step.allFinite()) return std::nullopt;
    const Four next = p + step.cwiseMax(-1.0).cwiseMin(1.0);
    const Likelihood there = likelihood(band, next, smear);
    const bool is_better = there.minus_log < here.minus_log;
    damp = is_better ? std::max(1e-9, 0.1 * damp) : 10.0 * damp;
    if (is_better) p = next, here = there;
    if (step.cwiseAbs().maxCoeff() < 1e-7 || damp > 1e6) break;
  }
  const double f0 = std::exp(p[1]), zeta = std::exp(p[2]);
  const Eigen::Matrix4d covariance = kCorrelated * here.information.inverse();
  if (f0 < lowest_hz || f0 > highest_hz || !covariance.allFinite() || !(covariance.diagonal().minCoeff() > 0.0))
    return std::nullopt;
  return RandomFit{f0, f0 * std::sqrt(covariance(1, 1)), zeta, zeta * std::sqrt(covariance(2, 2)), std::exp(p[0])};
}

}  // namespace moiregauge::internal
