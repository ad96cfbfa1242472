// SPDX-License-Identifier: Apache-2.0
// Linear operator on a series: every output row is a weighted sum of input rows. Filters have few weights near the row.
// A trend or a zero uses all rows, but has few degrees of freedom.
//
//     W = B + U V^T        B: a band, U and V: few columns
//
// So hours of frames stay cheap, and the noise of a filtered value follows exactly.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace moiregauge::internal {

// Weights of one output row. Without weights and with `has_value` false, the row has no value.
struct BandRow {
  Eigen::Index first = 0;
  Eigen::VectorXd weights;
  bool has_value = false;
};

class TimeOperator {
 public:
  // Returns the operator that changes nothing. Rows that are not in `is_ok` have no value.
  [[nodiscard]] static TimeOperator identity(const std::vector<bool>& is_ok);
  // `u`, `v`: may have no columns.
  TimeOperator(std::vector<BandRow> band, Eigen::MatrixXd u, Eigen::MatrixXd v)
      : band_(std::move(band)), u_(std::move(u)), v_(std::move(v)) {}

  [[nodiscard]] Eigen::Index rows() const { return static_cast<Eigen::Index>(band_.size()); }
  [[nodiscard]] bool has_value(Eigen::Index row) const { return band_[static_cast<std::size_t>(row)].has_value; }

  // Returns this operator after `first`.
  [[nodiscard]] TimeOperator after(const TimeOperator& first) const;
  // Returns the output for the columns of `input`. Rows without a value are NaN. Rows that no weight uses may be NaN.
  [[nodiscard]] Eigen::MatrixXd apply(const Eigen::MatrixXd& input) const;
  // Returns the variance of each output row for independent inputs with these variances.
  [[nodiscard]] Eigen::VectorXd variance(const Eigen::VectorXd& input) const;
  // Returns the weights of the inputs in the weighted sum of the output rows.
  [[nodiscard]] Eigen::VectorXd transposed(const Eigen::VectorXd& output) const;

 private:
  std::vector<BandRow> band_;
  Eigen::MatrixXd u_, v_;
};

}  // namespace moiregauge::internal
