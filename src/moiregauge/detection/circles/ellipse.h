// SPDX-License-Identifier: Apache-2.0
// An ellipse as the picture of the unit circle under an affine map: the shape in which small corrections are linear.
#pragma once

#include <cmath>

#include <Eigen/Dense>

namespace moiregauge::internal::markers_detail {

struct Ellipse {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();    // px
  Eigen::Matrix2d axes = Eigen::Matrix2d::Identity();  // px; symmetric, |axes^-1 (x - centre)| = 1 on the ellipse

  // From the area's second moments: a disc of radius r has variance r^2 / 4 along every direction.
  static Ellipse from_moments(const Eigen::Vector2d& mean, const Eigen::Matrix2d& covariance) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(4.0 * covariance);
    return {mean, solver.operatorSqrt()};
  }
  [[nodiscard]] double diameter() const { return 2.0 * std::sqrt(std::abs(axes.determinant())); }

  struct Shape {
    double axis_ratio = 1.0;
    double angle_rad = 0.0;  // of the major axis
    double minor_px = 0.0;   // half axis
    double major_px = 0.0;
  };
  [[nodiscard]] Shape shape() const {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(axes);
    const Eigen::Vector2d half = solver.eigenvalues().cwiseAbs();
    const Eigen::Vector2d major = solver.eigenvectors().col(half.y() >= half.x() ? 1 : 0);
    return {half.minCoeff() / half.maxCoeff(), std::atan(major.y() / major.x()), half.minCoeff(), half.maxCoeff()};
  }

  // The outline moved outwards by k0 + k1 cos + k2 sin + k3 cos 2 + k4 sin 2 (of the unit circle's polar angle, in
  // radii).
  [[nodiscard]] Ellipse corrected(const Eigen::Matrix<double, 5, 1>& k) const {
    Eigen::Matrix2d stretch;
    stretch << 1.0 + k[0] + k[3], k[4], k[4], 1.0 + k[0] - k[3];
    const Eigen::Matrix2d bent = axes * stretch;
    // Back to the symmetric root: an inner rotation of the unit circle changes nothing.
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(bent * bent.transpose());
    return {centre + axes * Eigen::Vector2d(k[1], k[2]), solver.operatorSqrt()};
  }
};

}  // namespace moiregauge::internal::markers_detail
