// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/camera_pose.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "moiregauge/units/units.h"

namespace moiregauge::internal {

std::array<double, 3> angles_of(const std::array<double, 3>& turn) {
  const Eigen::Vector3d axis(turn[0], turn[1], turn[2]);
  const double angle = axis.norm();
  const Eigen::Matrix3d r = angle > 0.0 ? Eigen::AngleAxisd(angle, axis / angle).toRotationMatrix()
                                        : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
  return {std::atan2(-r(1, 2), r(2, 2)), std::asin(std::clamp(r(0, 2), -1.0, 1.0)), std::atan2(-r(0, 1), r(0, 0))};
}

CameraPose camera_pose(const Pose& pose, const Eigen::Matrix<double, 6, 6>& covariance) {
  CameraPose out;
  out.angle_rad = angles_of(pose.turn);
  out.shift_mm = pose.shift;
  // Derivative of the angles by the turn. The angles are smooth, so the step only has to exceed rounding.
  constexpr double kStep = 1e-5;  // rad
  Eigen::Matrix3d change;
  for (std::size_t k = 0; k < 3; ++k) {
    auto less = pose.turn, more = pose.turn;
    less[k] -= kStep;
    more[k] += kStep;
    const auto before = angles_of(less), after = angles_of(more);
    for (std::size_t a = 0; a < 3; ++a)
      change(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(k)) =
          std::remainder(after[a] - before[a], kTwoPi) / (2.0 * kStep);
  }
  const Eigen::Matrix3d angles = change * covariance.topLeftCorner<3, 3>() * change.transpose();
  for (std::size_t k = 0; k < 3; ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    out.u_angle_rad[k] = std::sqrt(std::max(0.0, angles(row, row)));
    out.u_shift_mm[k] = std::sqrt(std::max(0.0, covariance(row + 3, row + 3)));
  }
  return out;
}

}  // namespace moiregauge::internal
