// SPDX-License-Identifier: Apache-2.0
// Pose of the camera in one frame, as camera.csv states it.
#pragma once

#include <array>

#include <Eigen/Core>

#include "moiregauge/displacement/sample.h"
#include "moiregauge/geometry/pose.h"

namespace moiregauge::internal {

// Maps the board to the camera: X_cam = Rx(angle[0]) Ry(angle[1]) Rz(angle[2]) (X, -Y, -Z) + shift, for a board point
// (X, Y, Z). Camera axes are x right, y down, z forward. All angles are 0 if the camera faces the board upright.
struct CameraPose {
  std::array<double, 3> angle_rad{kNotMeasured, kNotMeasured, kNotMeasured};
  std::array<double, 3> shift_mm{kNotMeasured, kNotMeasured, kNotMeasured};
  // Standard uncertainties (k = 1). They include noise, lens and marker positions.
  std::array<double, 3> u_angle_rad{kNotMeasured, kNotMeasured, kNotMeasured};
  std::array<double, 3> u_shift_mm{kNotMeasured, kNotMeasured, kNotMeasured};
};

// Returns the angles of a rotation R = Rx(a) Ry(b) Rz(c), rad, with b from -pi/2 to pi/2.
[[nodiscard]] std::array<double, 3> angles_of(const std::array<double, 3>& turn);

// Returns the pose with its uncertainties. `covariance`: of pose.turn (rad) and pose.shift (mm).
[[nodiscard]] CameraPose camera_pose(const Pose& pose, const Eigen::Matrix<double, 6, 6>& covariance);

}  // namespace moiregauge::internal
