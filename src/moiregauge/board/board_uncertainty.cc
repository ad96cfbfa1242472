// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "moiregauge/board/board_bundle.h"
#include "moiregauge/calibration/scene/normal_inverse.h"
#include "moiregauge/calibration/scene/patch_residual.h"

namespace moiregauge::internal {
namespace {

constexpr int kPatchColumns = 2 * static_cast<int>(kBoardPatches);

// Derivatives of one image point by camera, pose and board position, px per unit. Central differences, whose steps
// leave nine digits.
struct Slopes {
  Eigen::Matrix<double, 2, kCameraParameters> camera;
  Eigen::Matrix<double, 2, 6> pose;
  Eigen::Matrix2d board;
};

Slopes slopes_of(const CameraBlock& camera, const Pose& at, const std::array<double, 2>& board) {
  Slopes out;
  CameraBlock c = camera;
  std::array<double, 6> pose{at.turn[0], at.turn[1], at.turn[2], at.shift[0], at.shift[1], at.shift[2]};
  std::array<double, 2> b = board;
  const auto slope = [&](double& value, double step) {
    const double keep = value;
    value = keep + step;
    const auto high = projected(c.data(), pose.data(), {b[0], b[1], 0.0});
    value = keep - step;
    const auto low = projected(c.data(), pose.data(), {b[0], b[1], 0.0});
    value = keep;
    return Eigen::Vector2d((high[0] - low[0]) / (2.0 * step), (high[1] - low[1]) / (2.0 * step));
  };
  const double far = std::abs(at.shift[2]);
  for (int k = 0; k < kCameraParameters; ++k)
    out.camera.col(k) = slope(c[static_cast<std::size_t>(k)], k < 3 ? 1e-4 * camera[0] : 1e-4);
  for (int k = 0; k < 6; ++k) out.pose.col(k) = slope(pose[static_cast<std::size_t>(k)], k < 3 ? 1e-5 : 1e-5 * far);
  for (int k = 0; k < 2; ++k) out.board.col(k) = slope(b[static_cast<std::size_t>(k)], 1e-5 * far);
  return out;
}

// Sums over the views of one position, before its offset is eliminated.
struct PlaceSum {
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  Eigen::MatrixXd by_offset;
};

constexpr int kFirstPose = kCameraParameters + kPatchColumns;

// Returns the normal equations of camera, shifts of the ninths and poses, in this order. The offsets of positions are
// eliminated.
Eigen::MatrixXd normal_of(const BoardData& data, const BoardState& state) {
  const auto size = static_cast<Eigen::Index>(kFirstPose + 6 * static_cast<int>(data.views.size()));
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(size, size);
  std::vector<PlaceSum> places(static_cast<std::size_t>(data.places));
  for (std::size_t v = 0; v < data.views.size(); ++v) {
    const auto patch = patch_of(data.views[v]);
    for (std::size_t i = 0; i < patch.size(); ++i) {
      const BoardPoint at = data.views[v][i].board;
      const Slopes s = slopes_of(state.camera, state.poses[v], {at.x, at.y});
      Eigen::MatrixXd row = Eigen::MatrixXd::Zero(2, size);
      row.leftCols<kCameraParameters>() = s.camera;
      const int place = data.place[v][i];
      row.block<2, 2>(0, kCameraParameters + 2 * static_cast<int>(patch[i])).setIdentity();
      row.block<2, 6>(0, kFirstPose + 6 * static_cast<int>(v)) = s.pose;
      const double w = 1.0 / (data.u_px[v][i] * data.u_px[v][i]);
      std::vector<Eigen::Index> used;
      for (Eigen::Index k = 0; k < size; ++k) {
        if (row(0, k) != 0.0 || row(1, k) != 0.0) used.push_back(k);
      }
      for (const auto a : used) {
        for (const auto b : used) normal(a, b) += w * row.col(a).dot(row.col(b));
      }
      if (place == kNoPlace) continue;
      PlaceSum& sum = places[static_cast<std::size_t>(place)];
      if (sum.by_offset.size() == 0) sum.by_offset = Eigen::MatrixXd::Zero(2, size);
      sum.information += w * s.board.transpose() * s.board;
      sum.by_offset += w * s.board.transpose() * row;
    }
  }
  for (PlaceSum& sum : places) {
    if (sum.by_offset.size() == 0) continue;
    sum.information += Eigen::Matrix2d::Identity() / (data.print_mm * data.print_mm);
    normal -= sum.by_offset.transpose() * sum.information.inverse() * sum.by_offset;
  }
  return normal;
}

}  // namespace

CameraBlock uncertainty_of(const BoardData& data, const BoardPrior& prior, const BoardModel& model,
                           const BoardState& state, double patch_px) {
  const Eigen::MatrixXd normal = normal_of(data, state);
  constexpr int kKept = kFirstPose;
  const auto others = normal.rows() - kKept;
  const Eigen::MatrixXd kept =
      normal.topLeftCorner(kKept, kKept) - normal.topRightCorner(kKept, others) *
                                               inverse_of(normal.bottomRightCorner(others, others)) *
                                               normal.bottomLeftCorner(others, kKept);
  std::vector<int> used;
  const auto is_free = free_of(model);
  for (int k = 0; k < kCameraParameters; ++k) {
    if (is_free[static_cast<std::size_t>(k)]) used.push_back(k);
  }
  const auto n = static_cast<Eigen::Index>(used.size());
  Eigen::MatrixXd information(n, n), pull(n, kPatchColumns);
  for (Eigen::Index a = 0; a < n; ++a) {
    const int from = used[static_cast<std::size_t>(a)];
    for (Eigen::Index b = 0; b < n; ++b) information(a, b) = kept(from, used[static_cast<std::size_t>(b)]);
    const double u = prior.u[static_cast<std::size_t>(from)];
    information(a, a) += 1.0 / (u * u);
    pull.row(a) = kept.row(from).tail(kPatchColumns);
  }
  const Eigen::MatrixXd inverse = inverse_of(information);
  const Eigen::MatrixXd shifted = patch_px * inverse * pull;
  CameraBlock u{};
  for (Eigen::Index a = 0; a < n; ++a)
    u[static_cast<std::size_t>(used[static_cast<std::size_t>(a)])] =
        std::sqrt(std::max(0.0, inverse(a, a) + shifted.row(a).squaredNorm()));
  return u;
}

}  // namespace moiregauge::internal
