// SPDX-License-Identifier: Apache-2.0
// Products of design matrices with 18 rows and up to 35 columns. Eigen's product of such sizes packs both factors first,
// which takes longer than the sums. Here, blocks of rows have a fixed size, so that the compiler unrolls them.
#pragma once

#include <Eigen/Core>

namespace moiregauge::internal {

inline constexpr int kRowsAtOnce = 6;  // three vectors of two doubles

// A matrix with its columns as rows, and zeros up to a multiple of kRowsAtOnce rows.
template <int kRows, int kColumns>
class PaddedTranspose {
 public:
  static constexpr int kPadded = (kColumns + kRowsAtOnce - 1) / kRowsAtOnce * kRowsAtOnce;
  using Block = Eigen::Matrix<double, kRowsAtOnce, 1>;
  explicit PaddedTranspose(const Eigen::Matrix<double, kRows, kColumns>& matrix) {
    rows_.template topRows<kColumns>() = matrix.transpose();
    rows_.template bottomRows<kPadded - kColumns>().setZero();
  }
  // Returns rows `first` to first + kRowsAtOnce - 1 of the product with a column.
  template <typename Column>
  [[nodiscard]] Block times(const Column& column, int first) const {
    Block sum = Block::Zero();
    for (int k = 0; k < kRows; ++k) sum += column(k) * rows_.template block<kRowsAtOnce, 1>(first, k);
    return sum;
  }

 private:
  Eigen::Matrix<double, kPadded, kRows> rows_;
};

// Returns left^T right.
template <int kRows, int kLeft, int kRight>
[[nodiscard]] Eigen::Matrix<double, kLeft, kRight> product_of_columns(
    const Eigen::Matrix<double, kRows, kLeft>& left, const Eigen::Matrix<double, kRows, kRight>& right) {
  const PaddedTranspose<kRows, kLeft> by_rows(left);
  Eigen::Matrix<double, PaddedTranspose<kRows, kLeft>::kPadded, kRight> out;
  for (int b = 0; b < kRight; ++b) {
    for (int first = 0; first < kLeft; first += kRowsAtOnce)
      out.template block<kRowsAtOnce, 1>(first, b) = by_rows.times(right.col(b), first);
  }
  return out.template topRows<kLeft>();
}

// Returns matrix^T matrix. Only blocks that reach the lower triangle are summed.
template <int kRows, int kColumns>
[[nodiscard]] Eigen::Matrix<double, kColumns, kColumns> normal_matrix(
    const Eigen::Matrix<double, kRows, kColumns>& matrix) {
  const PaddedTranspose<kRows, kColumns> by_rows(matrix);
  Eigen::Matrix<double, PaddedTranspose<kRows, kColumns>::kPadded, kColumns> lower;
  Eigen::Matrix<double, kColumns, kColumns> out;
  for (int b = 0; b < kColumns; ++b) {
    for (int first = b - b % kRowsAtOnce; first < kColumns; first += kRowsAtOnce)
      lower.template block<kRowsAtOnce, 1>(first, b) = by_rows.times(matrix.col(b), first);
    for (int a = b; a < kColumns; ++a) out(a, b) = out(b, a) = lower(a, b);
  }
  return out;
}

}  // namespace moiregauge::internal
