// SPDX-License-Identifier: Apache-2.0
// The normal equations of fit_patch, from the sums of one pass: every entry is a moment of one product.
#pragma once

#include <Eigen/Core>

#include "moiregauge/phase/patch_pass.h"

namespace moiregauge {

// Unknowns in this order: b0 bu bv g0 gu gv, blur along X and along Y, then dX of u^i v^j (i fastest, i, j <= 2), then
// dY.
inline constexpr int kLightColumns = 6;
inline constexpr int kBlurColumns = 2;
inline constexpr int kBaseColumns = kLightColumns + kBlurColumns;
inline constexpr int kColumns = kBaseColumns + 2 * kFieldColumns;
using NormalMatrix = Eigen::Matrix<double, kColumns, kColumns>;
using NormalVector = Eigen::Matrix<double, kColumns, 1>;

void normal_equations(const PatchSums& sums, NormalMatrix& matrix, NormalVector& right);

}  // namespace moiregauge
