// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/phase/patch_moments.h"

namespace moiregauge {
namespace {

using enum PatchProduct;

struct Power {
  int u, v;
};
constexpr std::array<Power, 3> kBasePowers{{{0, 0}, {1, 0}, {0, 1}}};
constexpr Power field_power(int n) { return {n % 3, n / 3}; }

// The same blur all over the patch.
void write_blur(const PatchSums& sums, NormalMatrix& matrix, NormalVector& right) {
  constexpr std::array<std::array<PatchProduct, 2>, 2> kBlurLight{{{kBx, kTBx}, {kBy, kTBy}}};
  constexpr std::array<std::array<PatchProduct, 2>, 2> kBlurField{{{kBxTx, kBxTy}, {kByTx, kByTy}}};
  constexpr std::array<PatchProduct, 3> kBlurBlur{kBx2, kBxBy, kBy2};
  for (int i = 0; i < kBlurColumns; ++i) {
    const int row = kLightColumns + i;
    const auto k = static_cast<std::size_t>(i);
    right(row) = sums.moment(i == 0 ? kGBx : kGBy, 0, 0);
    for (int j = 0; j < kLightColumns; ++j) {
      const Power b = kBasePowers[static_cast<std::size_t>(j % 3)];
      matrix(row, j) = matrix(j, row) = sums.moment(kBlurLight[k][static_cast<std::size_t>(j / 3)], b.u, b.v);
    }
    for (int j = 0; j < kBlurColumns; ++j)
      matrix(row, kLightColumns + j) = sums.moment(kBlurBlur[static_cast<std::size_t>(i + j)], 0, 0);
    for (int j = 0; j < 2 * kFieldColumns; ++j) {
      const Power b = field_power(j % kFieldColumns);
      const PatchProduct f = kBlurField[k][static_cast<std::size_t>(j / kFieldColumns)];
      matrix(row, kBaseColumns + j) = matrix(kBaseColumns + j, row) = sums.moment(f, b.u, b.v);
    }
  }
}

}  // namespace

void normal_equations(const PatchSums& sums, NormalMatrix& matrix, NormalVector& right) {
  constexpr std::array<PatchProduct, 3> kBaseBase{kOne, kT, kT2};  // by how many of the two columns hold t
  constexpr std::array<std::array<PatchProduct, 2>, 2> kBaseField{{{kTx, kTy}, {kTTx, kTTy}}};
  constexpr std::array<PatchProduct, 3> kFieldField{kTx2, kTxTy, kTy2};
  for (int i = 0; i < kLightColumns; ++i) {
    const Power a = kBasePowers[static_cast<std::size_t>(i % 3)];
    const int t = i / 3;
    right(i) = sums.moment(t == 0 ? kGrey : kGreyT, a.u, a.v);
    for (int j = 0; j < kLightColumns; ++j) {
      const Power b = kBasePowers[static_cast<std::size_t>(j % 3)];
      matrix(i, j) = sums.moment(kBaseBase[static_cast<std::size_t>(t + j / 3)], a.u + b.u, a.v + b.v);
    }
    for (int j = 0; j < 2 * kFieldColumns; ++j) {
      const Power b = field_power(j % kFieldColumns);
      const PatchProduct f = kBaseField[static_cast<std::size_t>(t)][static_cast<std::size_t>(j / kFieldColumns)];
      matrix(i, kBaseColumns + j) = matrix(kBaseColumns + j, i) = sums.moment(f, a.u + b.u, a.v + b.v);
    }
  }
  write_blur(sums, matrix, right);
  for (int i = 0; i < 2 * kFieldColumns; ++i) {
    const Power a = field_power(i % kFieldColumns);
    right(kBaseColumns + i) = sums.moment(i < kFieldColumns ? kGTx : kGTy, a.u, a.v);
    for (int j = 0; j < 2 * kFieldColumns; ++j) {
      const Power b = field_power(j % kFieldColumns);
      matrix(kBaseColumns + i, kBaseColumns + j) =
          sums.moment(kFieldField[static_cast<std::size_t>(i / kFieldColumns + j / kFieldColumns)], a.u + b.u, a.v + b.v);
    }
  }
}

}  // namespace moiregauge
