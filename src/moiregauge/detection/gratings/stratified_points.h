// SPDX-License-Identifier: Apache-2.0
// Sample points that cover an area evenly but are not periodic: a regular raster would alias with a grating.
#pragma once

#include <cmath>
#include <cstdint>

#include <Eigen/Core>

namespace moiregauge::internal::markers_detail {

// Returns a pseudo-random number in [0, 1) for n (finaliser of SplitMix64, Steele et al. 2014).
[[nodiscard]] inline double stratified_points(std::uint64_t n) {
  n = (n + 1) * 0x9E3779B97F4A7C15U;
  n = (n ^ (n >> 30U)) * 0xBF58476D1CE4E5B9U;
  n = (n ^ (n >> 27U)) * 0x94D049BB133111EBU;
  return std::ldexp(static_cast<double>((n ^ (n >> 31U)) >> 11U), -53);
}

// Returns the i-th of side x side points in the unit square: one point at random in each cell of a raster.
[[nodiscard]] inline Eigen::Vector2d stratified_in_square(std::size_t i, std::size_t side) {
  const std::size_t column = i % side, row = i / side;
  const Eigen::Vector2d cell(static_cast<double>(column), static_cast<double>(row));
  return (cell + Eigen::Vector2d(stratified_points(2 * i), stratified_points(2 * i + 1))) / static_cast<double>(side);
}

}  // namespace moiregauge::internal::markers_detail
