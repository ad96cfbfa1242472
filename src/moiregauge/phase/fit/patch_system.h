// SPDX-License-Identifier: Apache-2.0
// The normal equations of a patch, ready to be solved for one right-hand side after another. In the window's own
// coordinates they are the same wherever the camera goes, but for how many pixels see the window: the print's slopes
// move with the print. So they are made once, in the reference frame, and later passes need right-hand sides only.
#pragma once

#include <optional>

#include <Eigen/Cholesky>

#include "moiregauge/phase/fit/patch_pass.h"

namespace moiregauge::internal {

inline constexpr int kPatchPoints = 9;
using PatchInformation = Eigen::Matrix<double, 2 * kPatchPoints, 2 * kPatchPoints>;

struct PatchFitOptions {
  int passes = 3;       // where normal equations are made in every pass. From 0.1 pitch two reach the fixed point
  int row_step = 1;     // follow_patch moves the patch as a whole by every row_step-th row
  bool along_x = true;  // the print shows motion along its x
  bool along_y = true;
  bool has_width = true;  // the width of lines is fitted: not of fundamentals alone, which have none
};

class PatchSystem {
 public:
  // Nothing when the window does not determine the unknowns. Columns of an axis that is not shown stay 0.
  [[nodiscard]] static std::optional<PatchSystem> of(const NormalMatrix& normal, int pixels,
                                                     const PatchFitOptions& options);
  // What it was made of.
  [[nodiscard]] const NormalMatrix& normal() const { return normal_; }
  [[nodiscard]] int pixels() const { return pixels_; }
  [[nodiscard]] const PatchFitOptions& options() const { return options_; }

  // The unknowns, where as many pixels as in the sums see the window.
  [[nodiscard]] NormalVector solved(const PatchSums& sums) const;
  // Returns the shift (pitches) that changes grey levels as much, rms, as blur and width of `value` do.
  [[nodiscard]] double shift_like(const NormalVector& value) const;
  // Of the field at the nine points (x of all, then y), per (grey level / gain)^2 of noise; the rest eliminated.
  [[nodiscard]] PatchInformation information(int pixels) const {
    return (static_cast<double>(pixels) / pixels_) * information_;
  }

 private:
  Eigen::LDLT<NormalMatrix> ldlt_;  // of columns of unit length
  NormalVector per_length_ = NormalVector::Zero();
  PatchInformation information_ = PatchInformation::Zero();
  NormalMatrix normal_ = NormalMatrix::Zero();
  int pixels_ = 0;
  PatchFitOptions options_;
};

// The field's nine coefficients to its values at the nine points, (u, v) = -2/3, 0, 2/3, u fastest.
[[nodiscard]] const Eigen::Matrix<double, kPatchPoints, kFieldColumns>& values_at_points();

}  // namespace moiregauge::internal
