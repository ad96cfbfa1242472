// SPDX-License-Identifier: Apache-2.0
// The least uncertainty that a layout of prints allows a displacement to have in one frame.
#pragma once

#include <limits>
#include <optional>
#include <span>

#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

// kPhase: the fundamental of each print; kFull: every edge that its template holds.
enum class Bound { kPhase, kFull };

// Inverse covariance, along the board's axes, of a shift of one print (per mm^2): the squared slopes of `print` at so
// many pixels of noise `sigma` (grey levels).
[[nodiscard]] Matrix2 shift_information(const Grating& grating, const PrintTemplate& print, double pixels, double sigma,
                                        Bound bound);

struct ReadPlace {
  BoardPoint at;        // mm
  Matrix2 information;  // of its shift, per mm^2; singular for lines
};

// Covariance (mm^2) at `target` of what the references say the board did, each counted by its information: as a
// homography (four or more), or as a rigid board before a camera whose centre is known, in the board's millimetres
// (three or more). Nothing when they do not determine it.
[[nodiscard]] std::optional<Matrix2> through_homography(std::span<const ReadPlace> references, BoardPoint target);
[[nodiscard]] std::optional<Matrix2> through_pose(std::span<const ReadPlace> references, BoardPoint target,
                                                  const Eigen::Vector3d& camera_centre);

// Of a shift that nothing determines.
inline constexpr double kUndetermined = std::numeric_limits<double>::quiet_NaN();

// Standard uncertainties (mm, k = 1) along the board's axes of a target's displacement in one frame like the reference
// frame, from the shifts of whole prints over every pixel of their size, lens and places known, through a homography.
// An axis that the print does not show is NaN; so are both where prints are not learned or references do not suffice.
[[nodiscard]] Extent<frame::Board> layout_bound(const Reference& reference, std::size_t target, Bound bound);

}  // namespace moiregauge::internal
