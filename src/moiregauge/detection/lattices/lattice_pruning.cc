// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "moiregauge/detection/lattices/lattice_growth.h"

namespace moiregauge::internal::markers_detail {
namespace {

// The limit of a residual is 6 times the median residual, but within these bounds.
constexpr double kMinResidual = 0.06;        // relative to the spacing
constexpr double kMaxResidual = 0.12;        // relative to the spacing
constexpr double kResidualInMedians = 6.0;   // chosen
constexpr double kMaxMedianResidual = 0.04;  // relative to the spacing; a larger median is no lattice (chosen)
constexpr double kMaxRemoved = 0.25;         // share of the points; if more are removed, it was no lattice (chosen)
constexpr double kThreadSizeRatio = 1.3;     // to the predicted size, for points with fewer than three neighbours

struct Residual {
  Cell cell;
  double relative = 1.0;    // residual / spacing
  double strictness = 1.0;  // factor on the residual: above 1 for points with fewer than three neighbours
};

Residual residual_of(const GrownLattice& lattice, std::span<const LatticeNode> nodes, Cell cell, std::size_t node) {
  Residual r{cell};
  const auto there = predict(lattice, nodes, cell, LocalModel::kQuadratic);
  if (there && there->spacing_px > 0.0) {
    r.relative = (nodes[node].at - there->at).norm() / there->spacing_px;
    if (there->neighbours < 3)
      r.strictness = alike_sizes(nodes[node].size_px, there->size_px, kThreadSizeRatio) ? 2.0 : 1e3;
  }
  return r;
}

// Residuals of a lattice during the removal of points. Only residuals near a removed point are computed again.
class LatticeResiduals {
 public:
  LatticeResiduals(const GrownLattice& lattice, std::span<const LatticeNode> nodes) : nodes_(nodes) {
    for (const auto& [cell, node] : lattice.node_at) of_.emplace(cell, residual_of(lattice, nodes, cell, node));
  }
  void lose(const GrownLattice& lattice, const std::vector<Cell>& lost) {
    std::set<Cell> changed;
    for (const Cell cell : lost) {
      of_.erase(cell);
      for (int dr = -kQuadraticReach; dr <= kQuadraticReach; ++dr) {
        for (int dc = -kQuadraticReach; dc <= kQuadraticReach; ++dc) changed.insert({cell.column + dc, cell.row + dr});
      }
    }
    for (const Cell cell : changed) {
      const auto found = lattice.node_at.find(cell);
      if (found != lattice.node_at.end()) of_[cell] = residual_of(lattice, nodes_, cell, found->second);
    }
  }
  [[nodiscard]] std::vector<Residual> all() const {
    std::vector<Residual> residuals;
    for (const auto& [cell, residual] : of_) residuals.push_back(residual);
    return residuals;
  }

 private:
  std::span<const LatticeNode> nodes_;
  std::map<Cell, Residual> of_;
};

double median_of(std::vector<Residual> residuals) {
  const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
  std::nth_element(residuals.begin(), middle, residuals.end(),
                   [](const auto& a, const auto& b) { return a.relative < b.relative; });
  return middle->relative;
}

bool is_worst_round(const std::map<Cell, double>& residual, Cell cell) {
  const double here = residual.at(cell);
  for (int dr = -2; dr <= 2; ++dr) {
    for (int dc = -2; dc <= 2; ++dc) {
      const auto other = residual.find({cell.column + dc, cell.row + dr});
      if (other != residual.end() && std::pair(other->second, other->first) > std::pair(here, cell)) return false;
    }
  }
  return true;
}

bool spans_three_by_three(const GrownLattice& lattice) {
  std::map<int, int> columns, rows;
  for (const auto& [cell, node] : lattice.node_at) {
    ++columns[cell.column];
    ++rows[cell.row];
  }
  return lattice.node_at.size() >= kMinLatticePoints && columns.size() >= 3 && rows.size() >= 3;
}

}  // namespace

bool prune(GrownLattice& lattice, std::span<const LatticeNode> nodes) {
  const auto fewest = static_cast<std::size_t>((1.0 - kMaxRemoved) * static_cast<double>(lattice.node_at.size()));
  LatticeResiduals known(lattice, nodes);
  while (spans_three_by_three(lattice) && lattice.node_at.size() >= fewest) {
    const auto residuals = known.all();
    const double median = median_of(residuals);
    const double limit = std::clamp(kResidualInMedians * median, kMinResidual, kMaxResidual);
    std::map<Cell, double> outside;
    for (const Residual& r : residuals) {
      if (r.relative * r.strictness > limit) outside[r.cell] = r.relative * r.strictness;
    }
    if (outside.empty()) return median < kMaxMedianResidual;
    // A wrong point distorts the predictions of its neighbours, so only the worst point of each neighbourhood is
    // removed.
    std::vector<Cell> lost;
    for (const auto& [cell, residual] : outside) {
      if (is_worst_round(outside, cell)) lost.push_back(cell);
    }
    for (const Cell cell : lost) lattice.node_at.erase(cell);
    known.lose(lattice, lost);
  }
  return false;
}

}  // namespace moiregauge::internal::markers_detail
