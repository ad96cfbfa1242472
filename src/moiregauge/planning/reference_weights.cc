// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/planning/reference_weights.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace moiregauge::internal {
namespace {

using FieldRows = Eigen::Matrix<double, 2, 8>;

// Returns the rows of the displacement field of a homography near the identity: eight parameters, linear.
FieldRows field(double x, double y) {
  FieldRows a;
  a << x, y, 1, 0, 0, 0, -x * x, -x * y,  //
      0, 0, 0, x, y, 1, -x * y, -y * y;
  return a;
}

}  // namespace

BoardExtent hypot3(BoardExtent a, BoardExtent b, BoardExtent c) {
  return {std::hypot(a.x, b.x, c.x), std::hypot(a.y, b.y, c.y)};
}

std::vector<Matrix2> reference_weights(std::span<const BoardPoint> references, BoardPoint target) {
  double reach = 0.0;  // coordinates relative to the target, in units of the layout, do not change the form
  for (const BoardPoint& p : references) reach = std::max(reach, length(p - target));
  const auto at = [&](BoardPoint p) { return field((p.x - target.x) / reach, (p.y - target.y) / reach); };
  Eigen::Matrix<double, 8, 8> normal = Eigen::Matrix<double, 8, 8>::Zero();
  for (const BoardPoint& p : references) normal += at(p).transpose() * at(p);
  const FieldRows here = field(0.0, 0.0);
  const Eigen::Matrix<double, 8, 2> response = normal.ldlt().solve(here.transpose());
  std::vector<Matrix2> weights;
  for (const BoardPoint& p : references) weights.emplace_back((at(p) * response).transpose());
  return weights;
}

Extent<frame::Board> through_references(std::span<const Matrix2> weights, std::span<const Extent<frame::Board>> u) {
  double xx = 0.0, yy = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const Matrix2& w = weights[i];
    xx += w(0, 0) * w(0, 0) * u[i].x * u[i].x + w(0, 1) * w(0, 1) * u[i].y * u[i].y;
    yy += w(1, 0) * w(1, 0) * u[i].x * u[i].x + w(1, 1) * w(1, 1) * u[i].y * u[i].y;
  }
  return {std::sqrt(xx), std::sqrt(yy)};
}

}  // namespace moiregauge::internal
