// SPDX-License-Identifier: Apache-2.0
// Least-squares fit of a sine, steady or decaying, to samples in time.
//
//     x(t) = exp(-lambda tau) (a cos(omega tau) + b sin(omega tau)) + c + d tau,   tau = t - origin
//
// For a steady sine in white noise the estimate reaches the Cramer-Rao bound u(f) = sqrt(6 / N) sigma / (pi A T) (D. C.
// Rife and R. R. Boorstyn, IEEE Trans. Inf. Theory 20, 1974, 591-598).
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace moiregauge::internal {

// Samples in time order, without gaps. Their times need not be even.
struct TimedValues {
  std::span<const double> time_s;
  std::span<const double> value;
};

enum class Decaying { kNo, kYes };  // kYes: lambda is free

struct SineFit {
  double origin_s = 0.0;
  double omega = 0.0;                                // rad/s, of the damped oscillation
  double lambda = 0.0;                               // 1/s
  std::array<double, 4> linear{};                    // a, b, c, d
  Eigen::Matrix2d spread;                            // covariance of omega and lambda per variance of one sample
  double square_sum = 0.0;                           // sum of squared residuals
  [[nodiscard]] double amplitude() const;            // at the origin, unit of the samples
  [[nodiscard]] double oscillation(double t) const;  // without c + d tau
  [[nodiscard]] double operator()(double t) const;
};

// Fits a sine in at most ten Gauss-Newton steps from `omega`, which must be within a quarter of 1 / duration of the
// true one.
// Fails (nothing): the samples do not determine it, or the steps end far from the start.
[[nodiscard]] std::optional<SineFit> fit_sine(const TimedValues& samples, double omega, Decaying decaying);

// Returns the omega of the best steady sine from lowest to highest, rad/s, in steps of a quarter of 1 / duration.
[[nodiscard]] double best_omega(const TimedValues& samples, double lowest, double highest);

// Returns the slow part of the motion, one value per sample: least-squares straight lines between knots that are
// `spacing_s` apart.
[[nodiscard]] std::vector<double> slow_part(const TimedValues& samples, double spacing_s);

}  // namespace moiregauge::internal
