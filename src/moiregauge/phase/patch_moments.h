// SPDX-License-Identifier: Apache-2.0
// The normal equations of fit_patch, summed as moments: every entry is a sum over pixels of u^k v^l f, with f one of a
// few products of grey level, template and its slopes, so a row of pixels costs powers of u only.
#pragma once

#include <array>

#include <Eigen/Core>

namespace moiregauge {

// Unknowns in this order: b0 bu bv g0 gu gv, blur along X and along Y, then dX of u^i v^j (i fastest, i, j <= 2), then
// dY.
inline constexpr int kLightColumns = 6;
inline constexpr int kBlurColumns = 2;
inline constexpr int kBaseColumns = kLightColumns + kBlurColumns;
inline constexpr int kFieldColumns = 9;
inline constexpr int kColumns = kBaseColumns + 2 * kFieldColumns;
using NormalMatrix = Eigen::Matrix<double, kColumns, kColumns>;
using NormalVector = Eigen::Matrix<double, kColumns, 1>;

struct PatchPixel {
  double u = 0.0;     // place along the row, about -1 to 1
  double grey = 0.0;  // less a constant, so that the sums keep their digits
  double t = 0.0;     // template
  double tx = 0.0;    // its slopes times the gain
  double ty = 0.0;
  double bx = 0.0;  // its second derivatives times the gain
  double by = 0.0;
};

class PatchMoments {
 public:
  void add(const PatchPixel& p);
  void end_row(double v);  // all pixels since the last call lie on this row
  void write(NormalMatrix& matrix, NormalVector& right) const;
  [[nodiscard]] int pixels() const { return pixels_; }
  [[nodiscard]] double grey_squared() const { return total_[kGrey2][0][0]; }

 private:
  // Products f whose moments are needed.
  enum Product {
    kTx2,
    kTxTy,
    kTy2,
    kTx,
    kTy,
    kTTx,
    kTTy,
    kGTx,
    kGTy,
    kOne,
    kT,
    kT2,
    kGrey,
    kGreyT,
    kGrey2,
    kBxTx,
    kBxTy,
    kByTx,
    kByTy,
    kBx,
    kBy,
    kTBx,
    kTBy,
    kGBx,
    kGBy,
    kBx2,
    kBxBy,
    kBy2,
    kProducts
  };
  static constexpr int kPowers = 5;
  [[nodiscard]] double moment(Product f, int k, int l) const {
    return total_[static_cast<std::size_t>(f)][static_cast<std::size_t>(k)][static_cast<std::size_t>(l)];
  }
  void write_blur(NormalMatrix& matrix, NormalVector& right) const;
  std::array<std::array<double, kPowers>, kProducts> row_{};                         // by power of u
  std::array<std::array<std::array<double, kPowers>, kPowers>, kProducts> total_{};  // and of v
  int pixels_ = 0;
};

}  // namespace moiregauge
