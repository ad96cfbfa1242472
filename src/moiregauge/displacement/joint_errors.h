// SPDX-License-Identifier: Apache-2.0
// Joint errors of a run: the covariance of all displacements and rotations, over targets, axes and frames.
//
// The error of a value is the sum of two parts. Noise is independent from frame to frame, with a covariance per frame.
// Shared factors are the same in all frames: reference frame, scene (lens, geometry, print scale) and readout time. A
// value's loadings state how far one u of each factor moves it.
//
//     cov(a in frame s, b in frame t) = noise_s(a, b) [s = t] + loadings_s(a) . loadings_t(b)
//
// Markers' positions in the site are further factors, which the values do not depend on. Functions of positions need
// them.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "moiregauge/units/point.h"

namespace moiregauge::internal {

// Values of a target in the order of the rows.
enum class Quantity { kDx, kDy, kRotation };
inline constexpr int kQuantities = 3;
[[nodiscard]] constexpr Eigen::Index quantity_row(std::size_t target, Quantity quantity) {
  return kQuantities * static_cast<Eigen::Index>(target) + static_cast<Eigen::Index>(quantity);
}

// Errors of one observation. Rows of values that were not measured are zero.
struct FrameErrors {
  Eigen::VectorXd rotation_rad;  // one per target, since the reference frame; NaN if not measured
  Eigen::MatrixXd noise;         // covariance by quantity_row, mm or rad
  // Part of `noise` that may also be the same in all frames: a lossy codec, an error of the model. Empty: none.
  Eigen::MatrixXd bounded;
  Eigen::MatrixXd varying;  // loadings of factors that act on every frame differently, mm or rad
  // Loadings of the factors in JointErrors::constant are those, times this: 1, or 0 in the reference frame.
  double constant_share = 1.0;
};

struct JointErrors {
  std::vector<std::size_t> targets;   // indices in the site, in the order of the rows
  std::vector<BoardPoint> positions;  // mm: those of the targets in the reference frame
  double u_position_mm = 0.0;         // the same for each coordinate; they are independent
  Eigen::MatrixXd constant;           // loadings of the reference frame's errors
  std::vector<FrameErrors> frames;    // one per observation
  // False: each value's errors are known alone, but not what different values share. Then only the diagonals are valid.
  bool knows_common_errors = true;
};

}  // namespace moiregauge::internal
