// SPDX-License-Identifier: Apache-2.0
// A quantity sampled in time, and how fast it changes at every sample: a spline whose smoothness the samples themselves
// tell.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace moiregauge::internal {

// Rates at one sample, per second, per second squared, per second cubed.
struct PathPoint {
  double rate = 0.0, acceleration = 0.0, jerk = 0.0;
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  // of rate and acceleration: what lies between the samples
};

// The quantity is taken for an m-fold integral of white noise (m = 2, 3 or 4), whose posterior mean is the smoothing
// spline of degree 2 m - 1 (Wahba 1978); m, the noise' strength and whether samples scatter more than they say are
// those of the greatest likelihood; Kalman's filter forth, Rauch, Tung and Striebel's smoother back. What moves faster
// than half the samples' rate looks slow here: no smoothness of samples tells it.
// time rises (s); variance: of each value's noise. Fewer than two samples say nothing: rates of zero, covariance zero.
[[nodiscard]] std::vector<PathPoint> smooth_path(std::span<const double> time_s, std::span<const double> value,
                                                 std::span<const double> variance);

}  // namespace moiregauge::internal
