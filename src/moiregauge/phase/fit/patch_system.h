// SPDX-License-Identifier: Apache-2.0
// Normal equations of one grating, prepared for many right-hand sides. In window coordinates they are the same in every
// frame, except for the number of pixels. The reason is that the template's slopes move with the grating. So they are
// computed once, in the reference frame, and later passes need right-hand sides only (decision 0020).
#pragma once

#include <optional>

#include <Eigen/Cholesky>

#include "moiregauge/phase/fit/patch_pass.h"

namespace moiregauge::internal {

inline constexpr int kPatchPoints = 9;
using PatchInformation = Eigen::Matrix<double, 2 * kPatchPoints, 2 * kPatchPoints>;

// Returns the position of point n in its window: u and v are -2/3, 0 or 2/3, u fastest.
[[nodiscard]] constexpr Point<frame::Window> window_point(int n) {
  const int column = n % 3, row = n / 3;
  return {(column - 1) * 2.0 / 3.0, (row - 1) * 2.0 / 3.0};
}
// Returns the same position in grating coordinates, pitches.
[[nodiscard]] constexpr PrintPoint grid_point(const PatchWindow& w, int n) {
  const Point<frame::Window> at = window_point(n);
  return {w.centre.x + at.x * w.half_x, w.centre.y + at.y * w.half_y};
}

struct PatchFitOptions {
  // Passes of fit_patch, each with normal equations of its own. From 0.1 pitch two reach the fixed point.
  int passes = 3;
  int row_step = 1;     // follow_patch shifts the window by every row_step-th row
  bool along_x = true;  // the grating shows motion along X
  bool along_y = true;
  // The width of the lines is fitted. Fundamentals alone have none.
  bool has_width = true;
};

class PatchSystem {
 public:
  // Factorises the normal equations. Columns of an axis that is not shown stay 0.
  // Fails (nothing): the window does not determine the unknowns.
  [[nodiscard]] static std::optional<PatchSystem> of(const NormalMatrix& normal, int pixels,
                                                     const PatchFitOptions& options);
  // Return the arguments of `of`.
  [[nodiscard]] const NormalMatrix& normal() const { return normal_; }
  [[nodiscard]] int pixels() const { return pixels_; }
  [[nodiscard]] const PatchFitOptions& options() const { return options_; }

  // Returns the unknowns for the sums over a window, whose number of pixels may differ from that of the normal
  // equations.
  [[nodiscard]] NormalVector solved(const PatchSums& sums) const;
  // Returns the shift (pitches) that changes grey levels as much, rms, as the largest of the changes of blur and width
  // in `value`.
  [[nodiscard]] double shift_like(const NormalVector& value) const;
  // Returns the information matrix of the field at the nine points (X of all, then Y), 1/pitch^2. The noise is one grey
  // level at unit gain. All other unknowns are eliminated.
  [[nodiscard]] PatchInformation information(int pixels) const {
    return (static_cast<double>(pixels) / pixels_) * information_;
  }

 private:
  Eigen::LDLT<NormalMatrix> ldlt_;  // factors for columns of unit length
  NormalVector per_length_ = NormalVector::Zero();
  PatchInformation information_ = PatchInformation::Zero();
  NormalMatrix normal_ = NormalMatrix::Zero();
  int pixels_ = 0;
  PatchFitOptions options_;
};

// Returns the matrix from the field's nine coefficients to its values at the nine points.
[[nodiscard]] const Eigen::Matrix<double, kPatchPoints, kFieldColumns>& values_at_points();

}  // namespace moiregauge::internal
