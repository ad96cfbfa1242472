// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/geometry/homography.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Dense>

namespace moiregauge::internal::detail {
namespace {

using Points = std::span<const Eigen::Vector2d>;

// Returns the similarity that moves the points' centroid to 0 and scales their rms radius to sqrt 2 (Hartley 1997,
// doi:10.1109/34.601246).
Matrix3 normaliser(Points points) {
  Eigen::Vector2d centroid = Eigen::Vector2d::Zero();
  for (const auto& p : points) centroid += p;
  centroid /= static_cast<double>(points.size());
  double sum = 0.0;
  for (const auto& p : points) sum += (p - centroid).squaredNorm();
  const double rms = std::sqrt(sum / static_cast<double>(points.size()));
  const double s = rms > 0.0 ? std::sqrt(2.0) / rms : 1.0;
  Matrix3 t;
  t << s, 0, -s * centroid.x(), 0, s, -s * centroid.y(), 0, 0, 1;
  return t;
}

std::vector<Eigen::Vector2d> mapped(const Matrix3& t, Points points) {
  std::vector<Eigen::Vector2d> out;
  out.reserve(points.size());
  for (const auto& p : points) out.push_back((t * p.homogeneous()).hnormalized());
  return out;
}

// A homography needs four points of which no three are on a line. For normalised points the last but one singular
// value of the design matrix tests this, for any number of points.
// Limit relative to the largest singular value; for four points, of their triangles' doubled areas. Chosen.
constexpr double kDegenerate = 1e-7;

tl::expected<Matrix3, HomographyFailure> direct_linear_solution(Points from, Points to) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(std::max<std::size_t>(2 * from.size(), 9)), 9);
  for (std::size_t i = 0; i < from.size(); ++i) {
    const auto r = static_cast<Eigen::Index>(2 * i);
    const Eigen::RowVector3d p = from[i].homogeneous().transpose();
    a.block<1, 3>(r, 0) = p;
    a.block<1, 3>(r, 6) = -to[i].x() * p;
    a.block<1, 3>(r + 1, 3) = p;
    a.block<1, 3>(r + 1, 6) = -to[i].y() * p;
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(a, Eigen::ComputeFullV);
  if (svd.singularValues()(7) < kDegenerate * svd.singularValues()(0))
    return tl::unexpected(HomographyFailure::kDegenerate);
  const Eigen::VectorXd h = svd.matrixV().col(8);
  Matrix3 m;
  m << h(0), h(1), h(2), h(3), h(4), h(5), h(6), h(7), h(8);
  return m;
}

// Returns the projective frame of four points. It maps the corners (1,0,0), (0,1,0), (0,0,1), (1,1,1) of the projective
// plane to them. Its columns are the first three points, weighted so that their sum is the fourth.
std::optional<Matrix3> frame_of(Points p) {
  Matrix3 m;
  m << p[0].homogeneous(), p[1].homogeneous(), p[2].homogeneous();
  const Eigen::Vector3d last = p[3].homogeneous();
  const double det = m.determinant();
  const Eigen::Vector3d weight{m.col(1).cross(m.col(2)).dot(last), m.col(2).cross(m.col(0)).dot(last),
                               m.col(0).cross(m.col(1)).dot(last)};
  // Twice the areas of the four triangles: zero means three points on a line.
  if (!(std::min(std::abs(det), weight.cwiseAbs().minCoeff()) > kDegenerate)) return std::nullopt;
  return Matrix3(m * (weight / det).asDiagonal());
}

tl::expected<Matrix3, HomographyFailure> through_four(Points from, Points to) {
  const auto a = frame_of(from), b = frame_of(to);
  if (!a || !b) return tl::unexpected(HomographyFailure::kDegenerate);
  return *b * a->inverse();
}

// Refines h by Gauss-Newton steps on the reprojection error. The step is orthogonal to h, which fixes the free scale.
void refine(Matrix3& h, Points from, Points to) {
  constexpr int kPasses = 5;  // quadratic convergence; a fixed number gives the same bits everywhere
  for (int pass = 0; pass < kPasses; ++pass) {
    h /= h.norm();
    Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Zero();
    Eigen::Matrix<double, 9, 1> rhs = Eigen::Matrix<double, 9, 1>::Zero();
    for (std::size_t i = 0; i < from.size(); ++i) {
      const Eigen::Vector3d p = from[i].homogeneous();
      const Eigen::Vector3d q = h * p;
      const Eigen::Vector2d uv = q.hnormalized();
      for (int c = 0; c < 2; ++c) {
        Eigen::Matrix<double, 9, 1> row = Eigen::Matrix<double, 9, 1>::Zero();
        row.segment<3>(3 * c) = p / q.z();
        row.segment<3>(6) = -uv(c) * p / q.z();
        normal += row * row.transpose();
        rhs += row * (to[i](c) - uv(c));
      }
    }
    Eigen::Matrix<double, 9, 1> flat;
    flat << h(0, 0), h(0, 1), h(0, 2), h(1, 0), h(1, 1), h(1, 2), h(2, 0), h(2, 1), h(2, 2);
    normal += flat * flat.transpose();
    const Eigen::Matrix<double, 9, 1> step = normal.ldlt().solve(rhs);
    h(0, 0) += step(0), h(0, 1) += step(1), h(0, 2) += step(2);
    h(1, 0) += step(3), h(1, 1) += step(4), h(1, 2) += step(5);
    h(2, 0) += step(6), h(2, 1) += step(7), h(2, 2) += step(8);
  }
}

}  // namespace

tl::expected<Matrix3, HomographyFailure> fit_homography(Points from, Points to) {
  if (from.size() != to.size() || from.size() < 4) return tl::unexpected(HomographyFailure::kTooFewPoints);
  const Matrix3 from_normaliser = normaliser(from);
  const Matrix3 to_normaliser = normaliser(to);
  const auto from_normal = mapped(from_normaliser, from);
  const auto to_normal = mapped(to_normaliser, to);
  auto h = from.size() == 4 ? through_four(from_normal, to_normal) : direct_linear_solution(from_normal, to_normal);
  if (!h) return h;
  if (from.size() > 4) refine(*h, from_normal, to_normal);
  Matrix3 result = to_normaliser.inverse() * *h * from_normaliser;
  return result / result(2, 2);
}

}  // namespace moiregauge::internal::detail
