// SPDX-License-Identifier: Apache-2.0
// Smoothing spline through a quantity sampled in time, and its rate at every sample. The smoothness follows from the
// samples.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace moiregauge::internal {

// Rate (1/s), acceleration (1/s^2) and jerk (1/s^3) at one sample, times the unit of the quantity.
struct PathPoint {
  double rate = 0.0, acceleration = 0.0, jerk = 0.0;
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  // covariance of rate and acceleration
};

// Fits a smoothing spline of degree 2 m - 1. It is the posterior mean of an m-fold integral of white noise, m = 2, 3 or
// 4 (Wahba 1978). The m, the strength of the noise and the excess scatter are those of the greatest likelihood. A
// Kalman filter and a Rauch-Tung-Striebel smoother evaluate it.
// `time_s`: increasing. `variance`: of the noise of each value.
// Limits: motion faster than half the sample rate looks slow. Fewer than two samples give rates and covariances of
// zero.
[[nodiscard]] std::vector<PathPoint> smooth_path(std::span<const double> time_s, std::span<const double> value,
                                                 std::span<const double> variance);

}  // namespace moiregauge::internal
