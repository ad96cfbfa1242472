// SPDX-License-Identifier: Apache-2.0
// One pass over a patch's raw pixels: everything that least squares needs of them, as sums. The hot loop of `precise`;
// it allocates nothing. Sixteen pixels side by side have a lane each, lanes are added in one fixed order, and no
// product is fused with a sum: the same bits on every SIMD target (Highway, chosen at run time).
#pragma once

#include <array>

#include "moiregauge/geometry/homography.h"
#include "moiregauge/image/image.h"
#include "moiregauge/phase/patch_fit.h"

namespace moiregauge {

inline constexpr int kFieldColumns = 9;

// Where a pixel lies in the print: a homography, plus a field biquadratic in the patch's own (u, v): u^i v^j, i fastest.
struct PatchMap {
  PrintFromImage map;
  double x0 = 0.0, y0 = 0.0, scale = 1.0;  // px: u = (x - x0) / scale, v = (y - y0) / scale
  std::array<double, kFieldColumns> dx{}, dy{};  // pitches
  // 1, u, v. Light and contrast are taken off the grey levels before they are summed; the slopes are times the gain.
  std::array<double, 3> light{}, contrast{}, gain{1.0, 0.0, 0.0};
};

// Products whose moments are needed, of what is left of the grey level g, template t, its slopes tx, ty and second derivatives bx, by.
enum class PatchProduct {
  kTx2, kTxTy, kTy2, kTx, kTy, kTTx, kTTy, kGTx, kGTy, kOne, kT, kT2, kGrey, kGreyT,
  kGrey2, kBxTx, kBxTy, kByTx, kByTy, kBx, kBy, kTBx, kTBy, kGBx, kGBy, kBx2, kBxBy, kBy2,
  kProducts
};
inline constexpr int kPatchProducts = static_cast<int>(PatchProduct::kProducts);
inline constexpr int kPatchPowers = 5;

// Sums over the window's pixels of product times u^k v^l. Up to four rows share their v, that of their middle.
struct PatchSums {
  std::array<double, static_cast<std::size_t>(kPatchProducts) * kPatchPowers * kPatchPowers> total{};
  [[nodiscard]] double& at(int f, int k, int l) {
    return total[static_cast<std::size_t>((f * kPatchPowers + k) * kPatchPowers + l)];
  }
  [[nodiscard]] double moment(PatchProduct f, int k, int l) const {
    return total[static_cast<std::size_t>((static_cast<int>(f) * kPatchPowers + k) * kPatchPowers + l)];
  }
  [[nodiscard]] int pixels() const { return static_cast<int>(moment(PatchProduct::kOne, 0, 0)); }
};

// Every row_step-th row of `box`, which must lie in the picture.
void sum_patch(const LumaView& luma, const PatchMap& map, const PatchWindow& window, const PrintNodes& nodes,
               const PixelBox& box, int row_step, PatchSums& sums);

}  // namespace moiregauge
