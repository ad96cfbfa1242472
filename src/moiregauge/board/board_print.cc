// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/LU>

#include "moiregauge/board/board_places.h"
#include "moiregauge/board/board_work.h"
#include "moiregauge/calibration/scene/frame_pose.h"

namespace moiregauge::internal {
namespace {

constexpr int kPrintRounds = 3;  // rounds of scatter and print error, each from the previous residuals; chosen

// Returns the residual of every point of a view, mm on the board.
std::vector<PlacedPoint> placed(const BoardWork& work, std::size_t v) {
  const IdealFromBoard view = view_of_pose(work.state.poses[v], work.state.camera);
  std::vector<PlacedPoint> out;
  for (const BoardPointSeen& p : work.data.views[v]) {
    const auto r = residual_of(work.state, v, p);
    out.push_back({p.column, -p.row, view.jacobian(p.board).inverse() * Eigen::Vector2d(r.x, r.y)});
  }
  return out;
}

// Rotates a view's board coordinates by quarter rotations, and its pose with them.
void turn_view(BoardWork& work, std::size_t v, int turns) {
  Matrix3 back = Matrix3::Identity();
  for (int k = 0; k < turns; ++k) back = back * (Matrix3() << 0, 1, 0, -1, 0, 0, 0, 0, 1).finished();
  const BoardView& view = *work.views[v];
  work.state.poses[v] = pose_of(IdealFromBoard(view_of_pose(work.state.poses[v], work.state.camera).matrix() * back),
                                camera_of(work.state.camera, view.width, view.height));
  work.turns[v] = turns;
}

// Numbers the positions that two or more views show.
void number_places(BoardWork& work, const std::vector<MatchedView>& matches) {
  std::map<std::pair<int, int>, int> seen, number;
  for (const MatchedView& view : matches) {
    for (const auto& cell : view.cells) ++seen[cell];
  }
  for (const auto& [cell, count] : seen) {
    if (count > 1) number.emplace(cell, static_cast<int>(number.size()));
  }
  work.places = static_cast<int>(number.size());
  for (std::size_t v = 0; v < matches.size(); ++v) {
    const auto& cells = matches[v].cells;
    if (cells.empty()) continue;
    turn_view(work, v, matches[v].turns);
    ++work.matched;
    std::size_t next = 0;
    for (std::size_t i = 0; i < work.place[v].size(); ++i) {
      if (work.is_outlier[v][i]) continue;
      const auto it = number.find(cells[next++]);
      if (it != number.end()) work.place[v][i] = it->second;
    }
  }
}

// Sum of the residuals at one position, over its views.
struct PlaceScatter {
  Eigen::Vector2d sum{0, 0};  // mm
  double count = 0.0;
};

// Separates print errors from scatter: a part common to all views of a position is the print's, the rest that of the
// points.
void tell_print_from_points(BoardWork& work) {
  std::vector<PlaceScatter> places(static_cast<std::size_t>(work.places));
  const auto each = [&](const auto& take) {
    for (std::size_t v = 0; v < work.data.views.size(); ++v) {
      const IdealFromBoard view = view_of_pose(work.state.poses[v], work.state.camera);
      for (std::size_t i = 0; i < work.data.views[v].size(); ++i) {
        if (work.data.place[v][i] == kNoPlace) continue;
        const BoardPointSeen& p = work.data.views[v][i];
        const auto r = residual_of(work.state, v, p);
        const Matrix2 j = view.jacobian(p.board);
        take(places[static_cast<std::size_t>(work.data.place[v][i])], p, j,
             Eigen::Vector2d(j.inverse() * Eigen::Vector2d(r.x, r.y)));
      }
    }
  };
  each([](PlaceScatter& s, const BoardPointSeen&, const Matrix2&, const Eigen::Vector2d& off) {
    s.sum += off;
    s.count += 1.0;
  });
  double within = 0.0, within_mm = 0.0, noise = 0.0, points = 0.0;
  each([&](PlaceScatter& s, const BoardPointSeen& p, const Matrix2& j, const Eigen::Vector2d& off) {
    const Eigen::Vector2d alone = off - s.sum / s.count;
    within += (j * alone).squaredNorm();
    within_mm += alone.squaredNorm();
    noise += p.u_px * p.u_px;
    points += 1.0;
  });
  double freedom = 2.0 * points - 6.0 * static_cast<double>(work.matched) - kCameraParameters;
  freedom = std::max(1.0, freedom - 2.0 * static_cast<double>(places.size()));
  work.point_px = std::sqrt(std::max(0.0, within / freedom - noise / points));
  double between = 0.0;
  for (const PlaceScatter& s : places) between += 0.5 * (s.sum / s.count).squaredNorm() - within_mm / freedom / s.count;
  work.print_mm = std::sqrt(std::max(0.0, between / static_cast<double>(places.size())));
}

}  // namespace

void solve_with_places(BoardWork& work, const BoardModel& model) {
  std::vector<std::vector<PlacedPoint>> views;
  for (std::size_t v = 0; v < work.views.size(); ++v) views.push_back(placed(work, v));
  const BoardWork alone = work;
  number_places(work, match_places(views));
  for (int round = 0; round < kPrintRounds && work.places > 0; ++round) {
    work.data = data_of(work);
    tell_print_from_points(work);
    if (!(work.print_mm > 0.0)) break;
    work.data = data_of(work);
    work.state = solve_board(work.data, work.prior, model, work.state);
  }
  if (work.places == 0 || !(work.print_mm > 0.0) || !work.state.solved) work = alone;
}

}  // namespace moiregauge::internal
