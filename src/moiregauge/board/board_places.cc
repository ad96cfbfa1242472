// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/board/board_places.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace moiregauge::internal {
namespace {

constexpr double kAlike = 0.3;      // least correlation of the residuals of two views; chosen
constexpr double kAhead = 0.1;      // least lead over the next best alignment; chosen
constexpr double kCertain = 6.0;    // least excess over chance, standard deviations; chosen
constexpr int kFarthest = 12;       // steps that one view may extend beyond another on one side; chosen
constexpr double kMinShared = 0.5;  // least share of common points, relative to the smaller view; chosen

struct Laid {
  int turns = 0;
  int x = 0, y = 0;
};

PlacedPoint laid(PlacedPoint p, const Laid& how) {
  for (int k = 0; k < how.turns; ++k) {
    p = {-p.y, p.x, {-p.off.y(), p.off.x()}};
  }
  return {p.x + how.x, p.y + how.y, p.off};
}

// Sums of the residuals over the views aligned so far, in a grid that holds them all.
class Board {
 public:
  explicit Board(int reach) : reach_(reach), side_(2 * reach + 1), cells_(static_cast<std::size_t>(side_ * side_)) {}
  void add(const PlacedPoint& p) {
    if (Cell* cell = at(p.x, p.y)) {
      cell->sum += p.off;
      cell->count += 1.0;
    }
  }
  struct Cell {
    Eigen::Vector2d sum{0, 0};
    double count = 0.0;
  };
  [[nodiscard]] Cell* at(int x, int y) {
    if (std::abs(x) > reach_ || std::abs(y) > reach_) return nullptr;
    return &cells_[static_cast<std::size_t>((y + reach_) * side_ + x + reach_)];
  }

 private:
  int reach_, side_;
  std::vector<Cell> cells_;
};

struct Likeness {
  double correlation = 0.0;
  double certainty = 0.0;  // in standard deviations of chance
};

Likeness likeness(Board& board, const std::vector<PlacedPoint>& view, const Laid& how, std::size_t least) {
  double xy = 0.0, xx = 0.0, yy = 0.0;
  std::size_t shared = 0;
  for (const PlacedPoint& point : view) {
    const PlacedPoint p = laid(point, how);
    const Board::Cell* cell = board.at(p.x, p.y);
    if (cell == nullptr || cell->count == 0.0) continue;
    const Eigen::Vector2d mean = cell->sum / cell->count;
    xy += mean.dot(p.off);
    xx += mean.squaredNorm();
    yy += p.off.squaredNorm();
    ++shared;
  }
  if (shared < least || !(xx > 0.0) || !(yy > 0.0)) return {};
  const double correlation = xy / std::sqrt(xx * yy);
  return {correlation, correlation * std::sqrt(2.0 * static_cast<double>(shared))};
}

struct Extents {
  int x0 = 0, x1 = 0, y0 = 0, y1 = 0;
};

Extents extents_of(const std::vector<PlacedPoint>& points, const Laid& how) {
  Extents e{1 << 20, -(1 << 20), 1 << 20, -(1 << 20)};
  for (const PlacedPoint& point : points) {
    const PlacedPoint p = laid(point, how);
    e = {std::min(e.x0, p.x), std::max(e.x1, p.x), std::min(e.y0, p.y), std::max(e.y1, p.y)};
  }
  return e;
}

bool is_whole(const std::vector<PlacedPoint>& points) {
  const Extents e = extents_of(points, {});
  return static_cast<long>(points.size()) == static_cast<long>(e.x1 - e.x0 + 1) * (e.y1 - e.y0 + 1);
}

// Finds the alignment of a view. Two full rectangles of one size differ by a rotation only. Others may also be shifted.
std::optional<Laid> lay(Board& board, const std::vector<PlacedPoint>& first, const std::vector<PlacedPoint>& view) {
  const Extents there = extents_of(first, {});
  const bool whole = is_whole(first) && is_whole(view) && first.size() == view.size();
  const auto least = static_cast<std::size_t>(kMinShared * static_cast<double>(std::min(first.size(), view.size())));
  Laid best;
  Likeness found;
  double second = -1.0;
  const auto judge = [&](const Laid& how) {
    const Likeness l = likeness(board, view, how, least);
    if (!(l.correlation > found.correlation)) {
      second = std::max(second, l.correlation);
      return;
    }
    second = found.correlation;
    found = l;
    best = how;
  };
  for (int turns = 0; turns < 4; ++turns) {
    const Extents here = extents_of(view, {turns, 0, 0});
    const int wider = here.x1 - here.x0 - (there.x1 - there.x0), higher = here.y1 - here.y0 - (there.y1 - there.y0);
    if (whole && (wider != 0 || higher != 0)) continue;
    const int far = whole ? 0 : kFarthest;
    for (int dy = -far; dy <= far; ++dy) {
      for (int dx = -far; dx <= far; ++dx)
        judge({turns, there.x0 - here.x0 - wider / 2 + dx, there.y0 - here.y0 - higher / 2 + dy});
    }
  }
  if (found.correlation < kAlike || found.certainty < kCertain || found.correlation < second + kAhead)
    return std::nullopt;
  return best;
}

}  // namespace

std::vector<MatchedView> match_places(const std::vector<std::vector<PlacedPoint>>& views) {
  std::vector<MatchedView> out(views.size());
  if (views.size() < 2) return out;
  const auto largest =
      std::max_element(views.begin(), views.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
  int reach = 0;
  for (const auto& view : views) {
    for (const PlacedPoint& p : view) reach = std::max({reach, std::abs(p.x), std::abs(p.y)});
  }
  Board board(3 * reach + 2 * kFarthest);
  const auto take = [&](std::size_t v, const Laid& how) {
    for (const PlacedPoint& point : views[v]) {
      const PlacedPoint p = laid(point, how);
      board.add(p);
      out[v].cells.emplace_back(p.x, p.y);
    }
    out[v].turns = how.turns;
  };
  const auto first = static_cast<std::size_t>(largest - views.begin());
  take(first, {});
  // Repeat until no view is added: each view improves the mean residuals, so others may then match.
  for (bool joined = true; joined;) {
    joined = false;
    for (std::size_t v = 0; v < views.size(); ++v) {
      if (!out[v].cells.empty() || views[v].empty()) continue;
      if (const auto how = lay(board, *largest, views[v])) {
        take(v, *how);
        joined = true;
      }
    }
  }
  if (std::count_if(out.begin(), out.end(), [](const MatchedView& m) { return !m.cells.empty(); }) < 2)
    out[first].cells.clear();
  return out;
}

}  // namespace moiregauge::internal
