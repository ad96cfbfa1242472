// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/simulator/scenario/gaussian.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numbers>

namespace moiregauge::internal::simulator {
namespace {

std::vector<double> make_below() {
  std::vector<double> table(static_cast<std::size_t>(2.0 * kGaussianReach * kGaussianSteps) + 2);
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double t = static_cast<double>(i) / kGaussianSteps - kGaussianReach;
    table[i] = 0.5 * std::erfc(-t / std::numbers::sqrt2);
  }
  return table;
}

// Returns the quantile of the normal distribution by bisection. It is slow, but runs only once per table entry.
double quantile(double share) {
  double low = -8.0, high = 8.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (0.5 * std::erfc(-middle / std::numbers::sqrt2) < share ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

constexpr std::size_t kQuantiles = 1U << 16U;

// Returns the quantiles at the middles of 65536 equal shares, scaled to a variance of exactly 1. The largest is 4.3.
std::vector<float> make_quantiles() {
  std::vector<double> exact(kQuantiles);
  double sum = 0.0;
  for (std::size_t i = 0; i < kQuantiles / 2; ++i) {
    exact[i] = quantile((static_cast<double>(i) + 0.5) / kQuantiles);
    exact[kQuantiles - 1 - i] = -exact[i];
    sum += 2.0 * exact[i] * exact[i];
  }
  const double stretch = std::sqrt(kQuantiles / sum);
  std::vector<float> table(kQuantiles);
  std::transform(exact.begin(), exact.end(), table.begin(), [&](double q) { return static_cast<float>(q * stretch); });
  return table;
}

// Mixes the bits (finaliser of SplitMix64: Steele, Lea, Flood 2014).
std::uint64_t mixed(std::uint64_t z) {
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
  return z ^ (z >> 31U);
}

constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15U;

}  // namespace

const std::vector<double> kGaussianBelow = make_below();

std::span<const Node> gauss_hermite(double correlation) {
  // Exact to degree 3, 5 and 9. The neglected terms are of the order of correlation^2, ^3 and ^5.
  static constexpr std::array kTwo{Node{-1.0, 0.5}, Node{1.0, 0.5}};
  static constexpr std::array kThree{Node{-1.7320508075688772, 1.0 / 6}, Node{0.0, 2.0 / 3},
                                     Node{1.7320508075688772, 1.0 / 6}};
  static constexpr std::array kFive{Node{-2.8569700138728056, 0.011257411327720691},
                                    Node{-1.3556261799742659, 0.22207592200561263}, Node{0.0, 8.0 / 15},
                                    Node{1.3556261799742659, 0.22207592200561263},
                                    Node{2.8569700138728056, 0.011257411327720691}};
  if (correlation < 0.003) return kTwo;
  if (correlation < 0.1) return kThree;
  return kFive;
}

std::vector<Node> gauss_legendre(int count) {
  std::vector<Node> nodes;
  for (int i = 0; i < count; ++i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (count + 0.5)), slope = 1.0;
    for (int step = 0; step < 50; ++step) {
      double before = 0.0, now = 1.0;
      for (int k = 1; k <= count; ++k) {
        const double next = ((2.0 * k - 1.0) * x * now - (k - 1.0) * before) / k;
        before = now;
        now = next;
      }
      slope = count * (x * now - before) / (x * x - 1.0);
      x -= now / slope;
    }
    nodes.push_back({0.5 * x, 1.0 / ((1.0 - x * x) * slope * slope)});
  }
  return nodes;
}

Noise::Noise(std::uint64_t seed, long frame) {
  static const std::vector<float> table = make_quantiles();
  quantiles_ = table.data();
  key_ = mixed(mixed(seed + kGolden) ^ (static_cast<std::uint64_t>(frame) * kGolden + 1U));
}

double Noise::at(std::uint64_t pixel) const {
  return static_cast<double>(quantiles_[mixed(key_ + pixel * kGolden) >> 48U]);
}

double hashed_unit(std::uint64_t seed, std::uint64_t address) {
  return static_cast<double>(mixed(mixed(seed + kGolden) + address * kGolden) >> 11U) * 0x1p-53;
}

}  // namespace moiregauge::internal::simulator
