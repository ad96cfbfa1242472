// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/phase/fit/patch_system.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace moiregauge::internal {
namespace {

// Ridge, relative to the diagonal. A single-harmonic grating cannot separate blur from contrast. The ridge assigns the
// change to contrast. Chosen.
constexpr double kBlurRidge = 1e-4;
constexpr double kMinPivot = 1e-9;  // for columns of unit length; chosen

using Values = Eigen::Matrix<double, kPatchPoints, kFieldColumns>;

Values made_values() {
  Values values;
  for (int n = 0; n < kPatchPoints; ++n) {
    const auto [u, v] = window_point(n);
    values.row(n) << 1, u, u * u, v, v * u, v * u * u, v * v, v * v * u, v * v * u * u;
  }
  return values;
}

PatchInformation at_points(const NormalMatrix& n, const PatchFitOptions& options) {
  const auto base = n.topLeftCorner<kBaseColumns, kBaseColumns>();
  const auto cross = n.topRightCorner<kBaseColumns, 2 * kFieldColumns>();
  const PatchInformation field =
      n.bottomRightCorner<2 * kFieldColumns, 2 * kFieldColumns>() - cross.transpose() * base.ldlt().solve(cross);
  const Values back = values_at_points().inverse();
  PatchInformation both = PatchInformation::Zero();
  if (options.along_x) both.topLeftCorner<kFieldColumns, kPatchPoints>() = back;
  if (options.along_y) both.bottomRightCorner<kFieldColumns, kPatchPoints>() = back;
  const PatchInformation whole = both.transpose() * field * both;
  return whole.selfadjointView<Eigen::Lower>();  // symmetric to the last bit, because files keep one triangle
}

// Removes columns from the fit: unit diagonal, zeros elsewhere.
void silence(NormalMatrix& n, int first, int columns) {
  for (int i = first; i < first + columns; ++i) {
    n.row(i).setZero();
    n.col(i).setZero();
    n(i, i) = 1.0;
  }
}

}  // namespace

const Values& values_at_points() {
  static const Values values = made_values();
  return values;
}

std::optional<PatchSystem> PatchSystem::of(const NormalMatrix& normal, int pixels, const PatchFitOptions& options) {
  NormalMatrix n = normal;
  const double slopes = n(0, 0) + n(3, 3);
  for (int i = kLightColumns; i < kBaseColumns; ++i) n(i, i) = n(i, i) * (1.0 + kBlurRidge) + 1e-12 * slopes;
  if (!options.along_x) silence(n, kLightColumns, 1), silence(n, kBaseColumns, kFieldColumns);
  if (!options.along_y) silence(n, kLightColumns + 1, 1), silence(n, kBaseColumns + kFieldColumns, kFieldColumns);
  if (!options.has_width) silence(n, kWidthColumn, kWidthColumns);
  PatchSystem s;
  // Columns of unit length make the pivots of grey levels and slopes comparable.
  s.per_length_ = n.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  s.ldlt_.compute(s.per_length_.asDiagonal() * n * s.per_length_.asDiagonal());
  if (s.ldlt_.info() != Eigen::Success || !s.ldlt_.isPositive() || !(s.ldlt_.vectorD().minCoeff() > kMinPivot))
    return std::nullopt;
  if (!options.along_x)
    s.per_length_(kLightColumns) = 0.0, s.per_length_.segment<kFieldColumns>(kBaseColumns).setZero();
  if (!options.along_y) s.per_length_(kLightColumns + 1) = 0.0, s.per_length_.tail<kFieldColumns>().setZero();
  if (!options.has_width) s.per_length_.segment<kWidthColumns>(kWidthColumn).setZero();
  s.information_ = at_points(n, options);
  s.normal_ = normal;
  s.pixels_ = pixels;
  s.options_ = options;
  return s;
}

NormalVector PatchSystem::solved(const PatchSums& sums) const {
  return (static_cast<double>(pixels_) / sums.pixels) *
         per_length_.cwiseProduct(ldlt_.solve(per_length_.cwiseProduct(sums.right)));
}

double PatchSystem::shift_like(const NormalVector& value) const {
  const double slope = std::max(normal_(kBaseColumns, kBaseColumns),
                                normal_(kBaseColumns + kFieldColumns, kBaseColumns + kFieldColumns));
  double largest2 = 0.0;
  for (int k = kLightColumns; k < kBaseColumns; ++k) largest2 = std::max(largest2, value(k) * value(k) * normal_(k, k));
  return std::sqrt(largest2 / slope);
}

}  // namespace moiregauge::internal
