// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/image/spline.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace moiregauge::internal {
namespace {

// Pole of the filter that inverts the B-spline sampled at whole pixels, (1, 4, 1) / 6.
const double kPole = std::sqrt(3.0) - 2.0;
constexpr int kHorizon = 28;  // px after which the filter's response is negligible: kPole^28 = 1e-16

// Filters one row, forwards and backwards.
void filter(std::span<double> c) {
  const int n = static_cast<int>(c.size());
  const auto at = [&](int i) -> double& { return c[static_cast<std::size_t>(i)]; };
  double first = 0.0, weight = 1.0;
  for (int i = 0; i < std::min(n, kHorizon); ++i, weight *= kPole) first += weight * at(i);
  at(0) = first;
  for (int i = 1; i < n; ++i) at(i) += kPole * at(i - 1);
  at(n - 1) = kPole / (kPole * kPole - 1.0) * (at(n - 1) + kPole * at(n - 2));
  for (int i = n - 2; i >= 0; --i) at(i) = kPole * (at(i + 1) - at(i));
  for (double& value : c) value *= 6.0;
}

// Filters the columns in the same way, whole rows at a time.
void filter_columns(Image<double>& c) {
  const int n = c.height();
  const auto add = [](std::span<double> to, std::span<const double> from, double times) {
    for (std::size_t x = 0; x < to.size(); ++x) to[x] += times * from[x];
  };
  double weight = kPole;
  for (int y = 1; y < std::min(n, kHorizon); ++y, weight *= kPole) add(c.row(0), c.row(y), weight);
  for (int y = 1; y < n; ++y) add(c.row(y), c.row(y - 1), kPole);
  add(c.row(n - 1), c.row(n - 2), kPole);
  for (double& value : c.row(n - 1)) value *= kPole / (kPole * kPole - 1.0);
  for (int y = n - 2; y >= 0; --y) {
    const std::span<double> row = c.row(y);
    const std::span<const double> below = c.row(y + 1);
    for (std::size_t x = 0; x < row.size(); ++x) row[x] = kPole * (below[x] - row[x]);
  }
  for (int y = 0; y < n; ++y) {
    for (double& value : c.row(y)) value *= 6.0;
  }
}

}  // namespace

void Spline::prefilter() {
  if (coefficients_.width() < 2 || coefficients_.height() < 2) return;
  for (int y = 0; y < coefficients_.height(); ++y) filter(coefficients_.row(y));
  filter_columns(coefficients_);
}

}  // namespace moiregauge::internal
