// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/derived/time_operator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace moiregauge::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Returns the matrix with zeros for values that were not measured. No weight uses them.
MatrixXd without_gaps(MatrixXd input) {
  for (double& value : input.reshaped()) {
    if (std::isnan(value)) value = 0.0;
  }
  return input;
}

// Returns the row of a band after a band.
BandRow row_after(const BandRow& row, const std::vector<BandRow>& first) {
  BandRow out;
  out.has_value = row.has_value;
  Index from = std::numeric_limits<Index>::max(), end = 0;
  for (Index k = 0; k < row.weights.size(); ++k) {
    const BandRow& inner = first[static_cast<std::size_t>(row.first + k)];
    if (row.weights(k) == 0.0) continue;
    out.has_value = out.has_value && inner.has_value;
    if (inner.weights.size() == 0) continue;
    from = std::min(from, inner.first);
    end = std::max(end, inner.first + inner.weights.size());
  }
  if (!out.has_value || end <= from) return out;
  out.first = from;
  out.weights = VectorXd::Zero(end - from);
  for (Index k = 0; k < row.weights.size(); ++k) {
    const BandRow& inner = first[static_cast<std::size_t>(row.first + k)];
    if (row.weights(k) != 0.0)
      out.weights.segment(inner.first - from, inner.weights.size()) += row.weights(k) * inner.weights;
  }
  return out;
}

}  // namespace

TimeOperator TimeOperator::identity(const std::vector<bool>& is_ok) {
  std::vector<BandRow> band(is_ok.size());
  for (std::size_t n = 0; n < is_ok.size(); ++n) {
    if (is_ok[n]) band[n] = {static_cast<Index>(n), VectorXd::Ones(1), true};
  }
  const auto size = static_cast<Index>(is_ok.size());
  return {std::move(band), MatrixXd(size, 0), MatrixXd(size, 0)};
}

// (B2 + U2 V2^T) (B1 + U1 V1^T) = B2 B1 + (B2 U1 + U2 (V2^T U1)) V1^T + U2 (B1^T V2)^T
TimeOperator TimeOperator::after(const TimeOperator& first) const {
  std::vector<BandRow> band;
  for (const BandRow& row : band_) band.push_back(row_after(row, first.band_));
  const TimeOperator inner_band(first.band_, MatrixXd(first.rows(), 0), MatrixXd(first.v_.rows(), 0));
  MatrixXd u(rows(), first.u_.cols() + u_.cols()), v(first.v_.rows(), u.cols());
  if (first.u_.cols() > 0) {
    MatrixXd through(rows(), first.u_.cols());
    for (Index n = 0; n < rows(); ++n) {
      const BandRow& row = band_[static_cast<std::size_t>(n)];
      through.row(n) = row.weights.transpose() * first.u_.middleRows(row.first, row.weights.size());
    }
    u.leftCols(first.u_.cols()) = through + u_ * (v_.transpose() * first.u_);
    v.leftCols(first.u_.cols()) = first.v_;
  }
  u.rightCols(u_.cols()) = u_;
  for (Index k = 0; k < u_.cols(); ++k) v.col(first.u_.cols() + k) = inner_band.transposed(v_.col(k));
  return {std::move(band), std::move(u), std::move(v)};
}

MatrixXd TimeOperator::apply(const MatrixXd& input) const {
  const MatrixXd clean = without_gaps(input);
  MatrixXd out = u_ * (v_.transpose() * clean);
  for (Index n = 0; n < rows(); ++n) {
    const BandRow& row = band_[static_cast<std::size_t>(n)];
    out.row(n) += row.weights.transpose() * clean.middleRows(row.first, row.weights.size());
    if (!row.has_value) out.row(n).setConstant(kNaN);
  }
  return out;
}

VectorXd TimeOperator::variance(const VectorXd& input) const {
  const MatrixXd weighted = input.asDiagonal() * v_;  // the noise of the second part's rows
  const MatrixXd whole = v_.transpose() * weighted;
  VectorXd out(rows());
  for (Index n = 0; n < rows(); ++n) {
    const BandRow& row = band_[static_cast<std::size_t>(n)];
    const Index size = row.weights.size();
    double sum = row.weights.cwiseAbs2().dot(input.segment(row.first, size));
    sum += 2.0 * (row.weights.transpose() * weighted.middleRows(row.first, size)).dot(u_.row(n));
    sum += u_.row(n).dot(u_.row(n) * whole);
    out(n) = row.has_value ? std::max(0.0, sum) : kNaN;
  }
  return out;
}

VectorXd TimeOperator::transposed(const VectorXd& output) const {
  VectorXd out = v_ * (u_.transpose() * output);
  for (Index n = 0; n < rows(); ++n) {
    const BandRow& row = band_[static_cast<std::size_t>(n)];
    out.segment(row.first, row.weights.size()) += output(n) * row.weights;
  }
  return out;
}

}  // namespace moiregauge::internal
