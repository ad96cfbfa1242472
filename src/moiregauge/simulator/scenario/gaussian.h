// SPDX-License-Identifier: Apache-2.0
// The normal distribution by table, quadrature rules, and noise that depends on nothing but its address.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace moiregauge::internal::simulator {

inline constexpr double kGaussianReach = 4.5;  // beyond it 3e-6 of the area is left: 6e-4 grey levels of 170

// Phi(t) within the reach (cut to 0 and 1 outside), to 3e-7: a table, straight between its entries.
inline constexpr double kGaussianSteps = 512.0;  // per unit of t
extern const std::vector<double> kGaussianBelow;
[[nodiscard]] inline double gaussian_below(double t) {
  const double at = (t + kGaussianReach) * kGaussianSteps;
  if (at <= 0.0) return 0.0;
  if (at >= 2.0 * kGaussianReach * kGaussianSteps) return 1.0;
  const auto i = static_cast<std::size_t>(at);
  const double low = kGaussianBelow[i];
  return low + (at - static_cast<double>(i)) * (kGaussianBelow[i + 1] - low);
}
[[nodiscard]] inline double gaussian_density(double t) { return 0.3989422804014327 * std::exp(-0.5 * t * t); }

struct Node {
  double at = 0.0;
  double weight = 0.0;
};

// Averages over a standard normal, with as many nodes as a shared part of this size needs.
[[nodiscard]] std::span<const Node> gauss_hermite(double correlation);
// Averages over [-1/2, 1/2]; weights add up to 1.
[[nodiscard]] std::vector<Node> gauss_legendre(int count);

// A standard normal number for (seed, frame, pixel): the same whoever asks, in whatever order.
class Noise {
 public:
  Noise(std::uint64_t seed, long frame);
  [[nodiscard]] double at(std::uint64_t pixel) const;

 private:
  std::uint64_t key_;
  const float* quantiles_;
};

// A number in [0, 1) for an address; for textures and layouts.
[[nodiscard]] double hashed_unit(std::uint64_t seed, std::uint64_t address);

}  // namespace moiregauge::internal::simulator
