// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/geometry/pose.h"

#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

namespace moiregauge::internal {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr int kMaxSteps = 20;        // chosen
constexpr double kReachedPx = 1e-9;  // converged: length of the residuals
// Step of the central differences: rad for rotations, relative to the camera's distance for shifts.
constexpr double kProbe = 1e-6;

Pose moved(const Pose& from, const Vector6& step, double distance) {
  const Eigen::Vector3d axis(from.turn[0], from.turn[1], from.turn[2]), more = step.head<3>();
  const auto rotation = [](const Eigen::Vector3d& a) {
    const double angle = a.norm();
    return angle > 0.0 ? Matrix3(Eigen::AngleAxisd(angle, a / angle)) : Matrix3(Matrix3::Identity());
  };
  const Eigen::AngleAxisd turn(Matrix3(rotation(more) * rotation(axis)));
  const Eigen::Vector3d now = turn.angle() * turn.axis();
  Pose to = from;
  for (int k = 0; k < 3; ++k) {
    to.turn[static_cast<std::size_t>(k)] = now[k];
    to.shift[static_cast<std::size_t>(k)] += distance * step[3 + k];
  }
  return to;
}

Vector6 misfit(const IdealFromBoard& view, std::span<const BoardPoint> board, std::span<const IdealPoint> ideal) {
  Vector6 r;
  for (std::size_t i = 0; i < 3; ++i) {
    const IdealPoint p = view(board[i]);
    r.segment<2>(2 * static_cast<Eigen::Index>(i)) << ideal[i].x - p.x, ideal[i].y - p.y;
  }
  return r;
}

}  // namespace

IdealFromBoard view_of(const Pose& pose, const Camera& camera) {
  const Eigen::Vector3d axis(pose.turn[0], pose.turn[1], pose.turn[2]);
  const double angle = axis.norm();
  const Matrix3 r = angle > 0.0 ? Eigen::AngleAxisd(angle, axis / angle).toRotationMatrix() : Matrix3::Identity();
  Matrix3 k, h;
  k << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1;
  h << r.col(0), -r.col(1), Eigen::Vector3d(pose.shift[0], pose.shift[1], pose.shift[2]);
  return IdealFromBoard(k * h);
}

Pose pose_of(const IdealFromBoard& view, const Camera& camera) {
  Matrix3 k;
  k << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1;
  // Columns are the images of the board's x, its y (downwards) and its origin, up to one scale.
  Matrix3 h = k.inverse() * view.matrix();
  h.col(1) *= -1.0;
  const double scale = 2.0 / (h.col(0).norm() + h.col(1).norm());
  h *= h(2, 2) < 0.0 ? -scale : scale;  // in front of the camera
  Matrix3 r;
  r << h.col(0), h.col(1), h.col(0).cross(h.col(1));
  const Eigen::JacobiSVD<Matrix3> svd(r, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix3 nearest = svd.matrixU() * svd.matrixV().transpose();
  if (nearest.determinant() < 0.0)
    nearest = svd.matrixU() * Eigen::Vector3d(1, 1, -1).asDiagonal() * svd.matrixV().transpose();
  const Eigen::AngleAxisd turn(nearest);
  const Eigen::Vector3d axis = turn.angle() * turn.axis();
  return {{axis.x(), axis.y(), axis.z()}, {h(0, 2), h(1, 2), h(2, 2)}};
}

std::optional<IdealFromBoard> view_of_three(std::span<const BoardPoint> board, std::span<const IdealPoint> ideal,
                                            const Camera& camera, const IdealFromBoard& near) {
  if (board.size() != 3 || ideal.size() != 3) return std::nullopt;
  Pose pose = pose_of(near, camera);
  const double distance = std::abs(pose.shift[2]);
  for (int step = 0; step < kMaxSteps; ++step) {
    const IdealFromBoard view = view_of(pose, camera);
    const Vector6 r = misfit(view, board, ideal);
    if (r.norm() < kReachedPx) return view;
    Matrix6 slopes;
    for (int k = 0; k < 6; ++k) {
      const Vector6 probe = kProbe * Vector6::Unit(k);
      slopes.col(k) = (misfit(view_of(moved(pose, -probe, distance), camera), board, ideal) -
                       misfit(view_of(moved(pose, probe, distance), camera), board, ideal)) /
                      (2.0 * kProbe);
    }
    const Eigen::FullPivLU<Matrix6> solver(slopes);
    if (!solver.isInvertible()) return std::nullopt;
    pose = moved(pose, solver.solve(r), distance);
  }
  return std::nullopt;
}

}  // namespace moiregauge::internal
