// SPDX-License-Identifier: Apache-2.0
// Normal distribution by table, quadrature rules, and reproducible noise that depends on its address only.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace moiregauge::internal::simulator {

inline constexpr double kGaussianReach = 4.5;    // sigma; the tail holds 3e-6, or 6e-4 of 170 grey levels
inline constexpr double kGaussianSteps = 512.0;  // table entries per unit of t
extern const std::vector<double> kGaussianBelow;

// Returns Phi(t) by linear interpolation in a table; 0 or 1 beyond the reach. Error: 3e-7.
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

// Returns the nodes for an average over a standard normal variable. The number of nodes (2, 3 or 5) grows with the
// correlation that the variable causes.
[[nodiscard]] std::span<const Node> gauss_hermite(double correlation);
// Returns `count` nodes for an average over [-1/2, 1/2]. The weights add up to 1.
[[nodiscard]] std::vector<Node> gauss_legendre(int count);

// Standard normal noise as a function of (seed, frame, pixel), independent of the order of calls.
class Noise {
 public:
  Noise(std::uint64_t seed, long frame);
  [[nodiscard]] double at(std::uint64_t pixel) const;

 private:
  std::uint64_t key_;
  const float* quantiles_;
};

// Returns a pseudo-random number in [0, 1) for an address, for textures and layouts.
[[nodiscard]] double hashed_unit(std::uint64_t seed, std::uint64_t address);

}  // namespace moiregauge::internal::simulator
