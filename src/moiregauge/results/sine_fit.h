// SPDX-License-Identifier: Apache-2.0
// A sine, steady or dying away, fitted to samples in time by least squares.
//
//   x(t) = exp(-lambda tau) (a cos(omega tau) + b sin(omega tau)) + c + d tau,   tau = t - origin
//
// For a steady sine in white noise the least-squares estimate reaches the Cramer-Rao bound
// u(f) = sqrt(6 / N) sigma / (pi A T) (D. C. Rife and R. R. Boorstyn, IEEE Trans. Inf. Theory 20, 1974, 591-598).
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace moiregauge::internal {

// Samples in time order, none of them a gap; they need not be even.
struct TimedValues {
  std::span<const double> time_s;
  std::span<const double> value;
};

enum class Decaying { kNo, kYes };  // is lambda free?

struct SineFit {
  double origin_s = 0.0;
  double omega = 0.0;                                // rad/s, of the oscillation seen
  double lambda = 0.0;                               // 1/s
  std::array<double, 4> linear{};                    // a, b, c, d
  Eigen::Matrix2d spread;                            // covariance of omega and lambda per variance of one sample
  double square_sum = 0.0;                           // of what is left
  double amplitude() const;                          // at the origin
  [[nodiscard]] double oscillation(double t) const;  // without c + d tau
  [[nodiscard]] double operator()(double t) const;
};

// At most ten Gauss-Newton passes from `omega`, which must be within a quarter of 1 / duration of the truth.
// Nothing when the samples do not determine it, or when the passes lead elsewhere.
[[nodiscard]] std::optional<SineFit> fit_sine(const TimedValues& samples, double omega, Decaying decaying);

// Of the frequencies lowest..highest (rad/s), in steps of a quarter of 1 / duration, that of the best steady sine.
[[nodiscard]] double best_omega(const TimedValues& samples, double lowest, double highest);

// What moves slowly: straight lines between knots, `spacing_s` apart, by least squares. One value per sample.
[[nodiscard]] std::vector<double> slow_part(const TimedValues& samples, double spacing_s);

}  // namespace moiregauge::internal
