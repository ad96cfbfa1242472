// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/board/board_start.h"

#include <algorithm>
#include <cmath>

namespace moiregauge::internal {

BoardView board_view(const SeenBoard& board, double pitch_mm, int width, int height) {
  BoardView view{width, height, {}};
  const double step = pitch_mm * board.step_pitches;
  for (const LatticePoint& p : board.points) {
    view.points.push_back({{step * (p.column - 0.5 * (board.columns - 1)), step * (0.5 * (board.rows - 1) - p.row)},
                           p.at,
                           p.u_px,
                           pitch_mm * board.diameter_pitches,
                           p.column,
                           p.row});
  }
  return view;
}

std::optional<IdealFromBoard> plane_view(const BoardView& view) {
  std::vector<BoardPoint> from;
  std::vector<IdealPoint> to;
  for (const BoardPointSeen& p : view.points) {
    from.push_back(p.board);
    to.push_back({p.at.x, p.at.y});
  }
  const auto h = fit_homography<frame::Ideal, frame::Board>(from, to);
  if (!h) return std::nullopt;
  return *h;
}

double focal_length_of(std::span<const IdealFromBoard> views, int width, int height) {
  const double side = std::max(width, height);
  // Solve a / f^2 + b = 0, two equations a view. Lengths are relative to the image's side, so that views weigh alike.
  double ab = 0.0, aa = 0.0;
  for (const IdealFromBoard& view : views) {
    Matrix3 to_middle = Matrix3::Identity();
    to_middle(0, 2) = -0.5 * (width - 1), to_middle(1, 2) = -0.5 * (height - 1);
    to_middle.topRows<2>() /= side;
    Matrix3 h = to_middle * view.matrix();
    h /= h.col(0).norm() + h.col(1).norm();
    const Eigen::Vector3d x = h.col(0), y = h.col(1);
    const double pairs[2][2] = {{x(0) * y(0) + x(1) * y(1), x(2) * y(2)},
                                {x(0) * x(0) + x(1) * x(1) - y(0) * y(0) - y(1) * y(1), x(2) * x(2) - y(2) * y(2)}};
    for (const auto& [a, b] : pairs) {
      ab += a * b;
      aa += b * b;
    }
  }
  // f^2 = -sum(a b) / sum(b b): the errors are in a, the image side of the equations.
  const double f2 = aa > 0.0 ? -ab / aa : 0.0;
  const double f = f2 > 0.0 ? std::sqrt(f2) : 0.0;
  return f > 0.2 && f < 50.0 ? f * side : 1.2 * side;
}

}  // namespace moiregauge::internal
