// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/planning/layout_bound.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include <Eigen/Dense>

#include "moiregauge/geometry/symmetric_eigen.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr double kNoInformation = 1e-6;  // limit relative to the other axis or the best determined parameter; chosen

bool is_fundamental(int m, int n, Pattern pattern) {
  return pattern == Pattern::kCheckerboard ? std::abs(m) == 1 && std::abs(n) == 1 : std::abs(m) + std::abs(n) == 1;
}

// Returns the covariance of a field at `target` by generalised least squares. The field is linear in its parameters,
// and `columns` gives it at a point.
template <typename Columns>
std::optional<Matrix2> through_field(std::span<const ReadPlace> references, BoardPoint target, Columns columns) {
  const Eigen::MatrixXd here = columns(target);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(here.cols(), here.cols());
  for (const ReadPlace& r : references) {
    const Eigen::MatrixXd a = columns(r.at);
    normal += a.transpose() * r.information * a;
  }
  const Eigen::VectorXd length = normal.diagonal().cwiseSqrt();
  if (!(length.minCoeff() > 0.0)) return std::nullopt;
  const Eigen::MatrixXd scaled = length.cwiseInverse().asDiagonal() * normal * length.cwiseInverse().asDiagonal();
  const SymmetricEigenX eigen = eigen_of(scaled);
  if (!(eigen.values(0) > kNoInformation * kNoInformation)) return std::nullopt;
  const Eigen::MatrixXd k = here * length.cwiseInverse().asDiagonal() * eigen.vectors;
  return Matrix2(k * eigen.values.cwiseInverse().asDiagonal() * k.transpose());
}

double reach_of(std::span<const ReadPlace> references, BoardPoint target) {
  double reach = 0.0;
  for (const ReadPlace& r : references) reach = std::max(reach, length(r.at - target));
  return reach;
}

// Returns the variances along the board's axes, mm^2. NaN for an axis that lines do not show.
Eigen::Vector2d own_variance(const Matrix2& information) {
  const SymmetricEigen2 eigen = eigen_of(information);
  const auto& strength = eigen.values;
  if (!(strength(1) > 0.0)) return {kUndetermined, kUndetermined};
  const bool has_both = strength(0) > kNoInformation * strength(1);
  Eigen::Vector2d variance = eigen.vectors.col(1).cwiseAbs2() / strength(1);
  for (int axis = 0; axis < 2; ++axis) {
    const double along = std::pow(eigen.vectors(axis, 0), 2);
    if (has_both)
      variance(axis) += along / strength(0);
    else if (along > kNoInformation)
      variance(axis) = kUndetermined;
  }
  return variance;
}

// Returns the noise of a pixel, grey levels. The harmonics of the template absorb a share of it, which is added again.
// If only fundamentals are fitted, the residual contains the pattern, and the noise from the image is smaller.
double noise_of(const MarkerObservation& seen, const PrintModel& model) {
  const double side = 2.0 * model.print.order() + 1.0;
  const double left = seen.points->sigma / std::sqrt(std::max(0.1, 1.0 - side * side / seen.points->pixels));
  return seen.patch.noise_sigma > 0.0 ? std::min(left, seen.patch.noise_sigma) : left;
}

std::optional<Matrix2> information_seen(const Reference& reference, std::size_t i, Bound bound) {
  const MarkerObservation& seen = reference.seen.markers[i];
  if (i >= reference.prints.size() || !reference.prints[i] || !seen.points) return std::nullopt;
  const Grating& print = *reference.site.markers[i].grating;
  const double mm_per_px = reference.view.mm_per_px(print.centre);
  const double pixels = print.width_mm * print.height_mm / (mm_per_px * mm_per_px);
  const double sigma = noise_of(seen, *reference.prints[i]) / seen.points->gain[0];
  if (!(sigma > 0.0)) return std::nullopt;
  return shift_information(print, reference.prints[i]->print, pixels, sigma, bound);
}

}  // namespace

Matrix2 shift_information(const Grating& grating, const PrintTemplate& print, double pixels, double sigma,
                          Bound bound) {
  const int order = bound == Bound::kPhase ? 1 : print.order();
  Matrix2 slopes = Matrix2::Zero();  // mean products of the slopes, 1/pitch^2
  for (int n = -order; n <= order; ++n) {
    for (int m = -order; m <= order; ++m) {
      if (bound == Bound::kPhase && !is_fundamental(m, n, grating.pattern)) continue;
      const Eigen::Vector2d wave(kTwoPi * m, kTwoPi * n);
      slopes += std::norm(print.coefficient(m, n)) * wave * wave.transpose();
    }
  }
  const double c = std::cos(grating.angle_rad), s = std::sin(grating.angle_rad);
  const Matrix2 turn = (Matrix2() << c, -s, s, c).finished() / grating.pitch_mm;
  return pixels / (sigma * sigma) * turn * slopes * turn.transpose();
}

// A homography near the identity is a field with eight columns, whatever view follows it.
std::optional<Matrix2> through_homography(std::span<const ReadPlace> references, BoardPoint target) {
  const double reach = reach_of(references, target);
  return through_field(references, target, [&](BoardPoint p) {
    const double x = (p.x - target.x) / reach, y = (p.y - target.y) / reach;
    Eigen::MatrixXd a(2, 8);
    a << x, y, 1, 0, 0, 0, x * x, x * y,  //
        0, 0, 0, x, y, 1, x * y, y * y;
    return a;
  });
}

// A rigid board shifts, rotates and tilts. A point lifted by h appears to move away from the camera's foot by the share
// h / height of its distance.
std::optional<Matrix2> through_pose(std::span<const ReadPlace> references, BoardPoint target,
                                    const Eigen::Vector3d& camera_centre) {
  const double reach = reach_of(references, target);
  return through_field(references, target, [&](BoardPoint p) {
    const double x = (p.x - target.x) / reach, y = (p.y - target.y) / reach;
    const double fx = (p.x - camera_centre.x()) / camera_centre.z(), fy = (p.y - camera_centre.y()) / camera_centre.z();
    Eigen::MatrixXd a(2, 6);
    a << 1, 0, -y, fx, x * fx, y * fx,  //
        0, 1, x, fy, x * fy, y * fy;
    return a;
  });
}

Extent<frame::Board> layout_bound(const Reference& reference, std::size_t target, Bound bound) {
  std::vector<ReadPlace> references;
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
    const Marker& marker = reference.site.markers[i];
    if (marker.role != Role::kReference || !marker.grating) continue;
    if (const auto information = information_seen(reference, i, bound))
      references.push_back({marker.grating->centre, *information});
  }
  const auto own = information_seen(reference, target, bound);
  if (!own) return {kUndetermined, kUndetermined};
  const auto through = through_homography(references, reference.site.markers[target].grating->centre);
  if (!through) return {kUndetermined, kUndetermined};
  const Eigen::Vector2d variance = own_variance(*own) + through->diagonal();
  return {std::sqrt(variance.x()), std::sqrt(variance.y())};
}

}  // namespace moiregauge::internal
