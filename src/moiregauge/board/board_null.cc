// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "moiregauge/board/board_calibration.h"
#include "moiregauge/geometry/view.h"

namespace moiregauge::internal {
namespace {

using Corners = std::array<std::size_t, 4>;

// Returns the points furthest along four directions, in that order.
Corners furthest(const std::vector<BoardPointSeen>& points, const std::array<BoardPoint, 4>& directions) {
  Corners corners{};
  for (std::size_t k = 0; k < 4; ++k) {
    const auto along = [&](const BoardPointSeen& p) {
      return directions[k].x * p.board.x + directions[k].y * p.board.y;
    };
    const auto it = std::max_element(points.begin(), points.end(),
                                     [&](const auto& p, const auto& q) { return along(p) < along(q); });
    corners[k] = static_cast<std::size_t>(it - points.begin());
  }
  return corners;
}

double area_of(const std::vector<BoardPointSeen>& points, const Corners& corners) {
  double twice = 0.0;
  for (std::size_t k = 0; k < 4; ++k) {
    const BoardPoint p = points[corners[k]].board, q = points[corners[(k + 1) % 4]].board;
    twice += p.x * q.y - p.y * q.x;
  }
  return 0.5 * std::abs(twice);
}

// Returns the four outermost points: the corners of a rectangle or of a diamond, whichever is larger.
Corners select_references(const std::vector<BoardPointSeen>& points) {
  const Corners square = furthest(points, {{{-1, 1}, {1, 1}, {1, -1}, {-1, -1}}});
  const Corners diamond = furthest(points, {{{0, 1}, {1, 0}, {0, -1}, {-1, 0}}});
  return area_of(points, square) >= area_of(points, diamond) ? square : diamond;
}

// Returns the rms residual of a homography through the references, at all other points or at all points.
double null_of(const std::vector<BoardPointSeen>& points, const std::vector<ImagePoint>& seen,
               const std::vector<std::size_t>& references, bool references_too) {
  std::vector<BoardPoint> from;
  std::vector<ImagePoint> to;
  for (const std::size_t k : references) {
    from.push_back(points[k].board);
    to.push_back(seen[k]);
  }
  const auto h = fit_homography<frame::Image, frame::Board>(from, to);
  double squares = 0.0, count = 0.0;
  for (std::size_t i = 0; h && i < points.size(); ++i) {
    if (!references_too && std::find(references.begin(), references.end(), i) != references.end()) continue;
    squares += std::pow(length(seen[i] - (*h)(points[i].board)), 2);
    count += 1.0;
  }
  return count > 0.0 ? std::sqrt(squares / count) : 0.0;
}

}  // namespace

BoardNull board_null(const BoardView& view, const Camera& camera) {
  std::vector<ImagePoint> seen, ideal;
  std::vector<std::size_t> all;
  for (const BoardPointSeen& p : view.points) {
    const IdealPoint without = camera.undistort(p.at);
    seen.push_back(p.at);
    ideal.push_back({without.x, without.y});
    all.push_back(all.size());
  }
  if (all.size() < 5) return {};
  const Corners four = select_references(view.points);
  const std::vector<std::size_t> corners(four.begin(), four.end());
  return {null_of(view.points, seen, corners, false), null_of(view.points, ideal, corners, false),
          null_of(view.points, seen, all, true), null_of(view.points, ideal, all, true)};
}

}  // namespace moiregauge::internal
