// SPDX-License-Identifier: Apache-2.0
// Cramer-Rao bound of a displacement in one frame, for a layout of gratings.
#pragma once

#include <limits>
#include <optional>
#include <span>

#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

// kPhase: fundamentals only. kFull: all harmonics of the template.
enum class Bound { kPhase, kFull };

// Returns the Fisher information of one grating's shift along the board's axes, 1/mm^2. It is the sum of the squared
// slopes of `print` over `pixels` pixels, divided by the square of the noise `sigma` (grey levels).
[[nodiscard]] Matrix2 shift_information(const Grating& grating, const PrintTemplate& print, double pixels, double sigma,
                                        Bound bound);

struct ReadPlace {
  BoardPoint at;        // mm
  Matrix2 information;  // about its shift, 1/mm^2; singular for lines
};

// Return the covariance at `target` of the board's motion from the references, mm^2 (generalised least squares).
// `through_homography` needs four or more. `through_pose` needs three or more, and a known camera centre in board
// millimetres.
// Fail (nothing): the references do not determine the motion.
[[nodiscard]] std::optional<Matrix2> through_homography(std::span<const ReadPlace> references, BoardPoint target);
[[nodiscard]] std::optional<Matrix2> through_pose(std::span<const ReadPlace> references, BoardPoint target,
                                                  const Eigen::Vector3d& camera_centre);

// Value of a shift that nothing determines.
inline constexpr double kUndetermined = std::numeric_limits<double>::quiet_NaN();

// Returns the bound of a target's displacement in one frame like the reference frame, along the board's axes (mm, k =
// 1). Every grating is used in full size, lens and positions are known, and the references act through a homography.
// NaN: an axis that the grating does not show. Both are NaN if templates are missing or the references do not suffice.
[[nodiscard]] Extent<frame::Board> layout_bound(const Reference& reference, std::size_t target, Bound bound);

}  // namespace moiregauge::internal
