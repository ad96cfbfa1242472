// SPDX-License-Identifier: Apache-2.0
// Ellipse as the image of the unit circle under an affine map. In this form small corrections of the outline are
// linear.
#pragma once

#include <cmath>

#include <Eigen/Core>
#include <Eigen/LU>

#include "moiregauge/geometry/symmetric_eigen.h"

namespace moiregauge::internal::markers_detail {

struct Ellipse {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();    // px
  Eigen::Matrix2d axes = Eigen::Matrix2d::Identity();  // px; symmetric, |axes^-1 (x - centre)| = 1 on the ellipse

  // Returns the ellipse with the given area moments (px and px^2). A disc of radius r has variance r^2 / 4 along every
  // direction.
  static Ellipse from_moments(const Eigen::Vector2d& mean, const Eigen::Matrix2d& covariance) {
    return {mean, symmetric_root(4.0 * covariance)};
  }
  [[nodiscard]] double diameter() const { return 2.0 * std::sqrt(std::abs(axes.determinant())); }

  struct Shape {
    double axis_ratio = 1.0;
    double angle_rad = 0.0;  // rad, of the major axis, from x towards y
    double minor_px = 0.0;   // px, half axis
    double major_px = 0.0;   // px, half axis
  };
  [[nodiscard]] Shape shape() const {
    const SymmetricEigen2 eigen = eigen_of(axes);
    const Eigen::Vector2d half = eigen.values.cwiseAbs();
    const Eigen::Vector2d major = eigen.vectors.col(half.y() >= half.x() ? 1 : 0);
    return {half.minCoeff() / half.maxCoeff(), std::atan(major.y() / major.x()), half.minCoeff(), half.maxCoeff()};
  }

  // Returns the ellipse with its outline moved outwards by k0 + k1 cos a + k2 sin a + k3 cos 2a + k4 sin 2a, in radii.
  // The angle a is the polar angle on the unit circle. Exact to first order in k.
  [[nodiscard]] Ellipse corrected(const Eigen::Matrix<double, 5, 1>& k) const {
    Eigen::Matrix2d stretch;
    stretch << 1.0 + k[0] + k[3], k[4], k[4], 1.0 + k[0] - k[3];
    const Eigen::Matrix2d bent = axes * stretch;
    // Restores the symmetric root. A rotation of the unit circle does not change the ellipse.
    return {centre + axes * Eigen::Vector2d(k[1], k[2]), symmetric_root(bent * bent.transpose())};
  }
};

}  // namespace moiregauge::internal::markers_detail
