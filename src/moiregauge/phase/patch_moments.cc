// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/phase/patch_moments.h"

namespace moiregauge {
namespace {

// Highest power of u (and of v) that each product is needed with, in the order of PatchMoments::Product.
constexpr std::array<int, 28> kHighest{4, 4, 4, 3, 3, 3, 3, 2, 2, 2, 2, 2, 1, 1,
                                       0, 2, 2, 2, 2, 1, 1, 1, 1, 0, 0, 0, 0, 0};

struct Power {
  int u, v;
};
constexpr std::array<Power, 3> kBasePowers{{{0, 0}, {1, 0}, {0, 1}}};
constexpr Power field_power(int n) { return {n % 3, n / 3}; }

}  // namespace

void PatchMoments::add(const PatchPixel& p) {
  const std::array<double, kProducts> f{
      p.tx * p.tx,     p.tx * p.ty,   p.ty * p.ty,   p.tx,          p.ty,        p.t * p.tx,  p.t * p.ty,
      p.grey * p.tx,   p.grey * p.ty, 1.0,           p.t,           p.t * p.t,   p.grey,      p.grey * p.t,
      p.grey * p.grey, p.bx * p.tx,   p.bx * p.ty,   p.by * p.tx,   p.by * p.ty, p.bx,        p.by,
      p.t * p.bx,      p.t * p.by,    p.grey * p.bx, p.grey * p.by, p.bx * p.bx, p.bx * p.by, p.by * p.by};
  for (std::size_t i = 0; i < kProducts; ++i) {
    double power = f[i];
    row_[i][0] += power;
    for (int k = 1; k <= kHighest[i]; ++k) row_[i][static_cast<std::size_t>(k)] += power *= p.u;
  }
  ++pixels_;
}

void PatchMoments::end_row(double v) {
  for (std::size_t i = 0; i < kProducts; ++i) {
    const auto highest = static_cast<std::size_t>(kHighest[i]);
    for (std::size_t k = 0; k <= highest; ++k) {
      double value = row_[i][k];
      for (std::size_t l = 0; l <= highest; ++l, value *= v) total_[i][k][l] += value;
      row_[i][k] = 0.0;
    }
  }
}

void PatchMoments::write(NormalMatrix& matrix, NormalVector& right) const {
  constexpr std::array<Product, 3> kBaseBase{kOne, kT, kT2};  // by how many of the two columns hold t
  constexpr std::array<std::array<Product, 2>, 2> kBaseField{{{kTx, kTy}, {kTTx, kTTy}}};
  constexpr std::array<Product, 3> kFieldField{kTx2, kTxTy, kTy2};
  for (int i = 0; i < kLightColumns; ++i) {
    const Power a = kBasePowers[static_cast<std::size_t>(i % 3)];
    const int t = i / 3;
    right(i) = moment(t == 0 ? kGrey : kGreyT, a.u, a.v);
    for (int j = 0; j < kLightColumns; ++j) {
      const Power b = kBasePowers[static_cast<std::size_t>(j % 3)];
      matrix(i, j) = moment(kBaseBase[static_cast<std::size_t>(t + j / 3)], a.u + b.u, a.v + b.v);
    }
    for (int j = 0; j < 2 * kFieldColumns; ++j) {
      const Power b = field_power(j % kFieldColumns);
      const Product f = kBaseField[static_cast<std::size_t>(t)][static_cast<std::size_t>(j / kFieldColumns)];
      matrix(i, kBaseColumns + j) = matrix(kBaseColumns + j, i) = moment(f, a.u + b.u, a.v + b.v);
    }
  }
  write_blur(matrix, right);
  for (int i = 0; i < 2 * kFieldColumns; ++i) {
    const Power a = field_power(i % kFieldColumns);
    right(kBaseColumns + i) = moment(i < kFieldColumns ? kGTx : kGTy, a.u, a.v);
    for (int j = 0; j < 2 * kFieldColumns; ++j) {
      const Power b = field_power(j % kFieldColumns);
      matrix(kBaseColumns + i, kBaseColumns + j) =
          moment(kFieldField[static_cast<std::size_t>(i / kFieldColumns + j / kFieldColumns)], a.u + b.u, a.v + b.v);
    }
  }
}

// The same blur all over the patch.
void PatchMoments::write_blur(NormalMatrix& matrix, NormalVector& right) const {
  constexpr std::array<std::array<Product, 2>, 2> kBlurLight{{{kBx, kTBx}, {kBy, kTBy}}};
  constexpr std::array<std::array<Product, 2>, 2> kBlurField{{{kBxTx, kBxTy}, {kByTx, kByTy}}};
  constexpr std::array<Product, 3> kBlurBlur{kBx2, kBxBy, kBy2};
  for (int i = 0; i < kBlurColumns; ++i) {
    const int row = kLightColumns + i;
    const auto k = static_cast<std::size_t>(i);
    right(row) = moment(i == 0 ? kGBx : kGBy, 0, 0);
    for (int j = 0; j < kLightColumns; ++j) {
      const Power b = kBasePowers[static_cast<std::size_t>(j % 3)];
      matrix(row, j) = matrix(j, row) = moment(kBlurLight[k][static_cast<std::size_t>(j / 3)], b.u, b.v);
    }
    for (int j = 0; j < kBlurColumns; ++j)
      matrix(row, kLightColumns + j) = moment(kBlurBlur[static_cast<std::size_t>(i + j)], 0, 0);
    for (int j = 0; j < 2 * kFieldColumns; ++j) {
      const Power b = field_power(j % kFieldColumns);
      const Product f = kBlurField[k][static_cast<std::size_t>(j / kFieldColumns)];
      matrix(row, kBaseColumns + j) = matrix(kBaseColumns + j, row) = moment(f, b.u, b.v);
    }
  }
}

}  // namespace moiregauge
